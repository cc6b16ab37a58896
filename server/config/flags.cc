// The flags of arapd.
#include <chrono>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/config/config.h"
#include "server/host/listen.h"

namespace arap::config {
namespace {

constexpr double kDay = 86'400;
constexpr const char* kLimitGroup = "Limits";
constexpr const char* kStopping = "Readiness and stopping";
constexpr const char* kLogs = "Logs and metrics";

template <class Value>
CLI::Option* AddValue(CLI::App& app, const LimitInfo& info, Value& value) {
  return app.add_option("--" + FlagName(info), value, std::string(info.meaning))
      ->capture_default_str();
}

CLI::Option* AddValue(CLI::App& app, const LimitInfo& info, std::chrono::milliseconds& value) {
  const auto set = [&value](double seconds) { value = Milliseconds(seconds); };
  return app.add_option_function<double>("--" + FlagName(info), set, std::string(info.meaning))
      ->default_str(fmt::format("{}", std::chrono::duration<double>(value).count()));
}

void AddLimits(CLI::App& app, Config& config) {
  for (const LimitInfo& info : kLimits) {
    VisitLimit(config.host.limits, info, [&](auto& value) {
      AddValue(app, info, value)
          ->check(CLI::Range(info.smallest, info.largest))
          ->group(kLimitGroup);
    });
  }
}

void AddConnections(CLI::App& app, Config& config) {
  rpc::ConnectionBounds& bounds = config.host.connections;
  app.add_option("--max-connections", bounds.most,
                 "Open connections; fewer where there are not enough file descriptors")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6))
      ->group(kLimitGroup);
  app.add_option("--max-connections-per-address", bounds.most_per_address,
                 "Of one IPv4 address or IPv6 network of 64 bits")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6))
      ->group(kLimitGroup);
  app.add_option(
         "--max-unknown-calls", bounds.unknown_calls,
         "Calls that are not let in, of one connection, before it is cut and its address is "
         "on probation; 0: neither")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e9))
      ->group(kLimitGroup);
  app.add_option("--max-receiving-bytes", bounds.receiving_bytes,
                 "Bytes of all requests that have begun and are not complete")
      ->capture_default_str()
      ->check(CLI::Range(1e3, 1e12))
      ->group(kLimitGroup);
  const auto seconds = [&app](const char* name, std::chrono::milliseconds& time, const char* help) {
    app.add_option_function<double>(
           name, [&time](double value) { time = Milliseconds(value); }, help)
        ->default_str(fmt::format("{}", std::chrono::duration<double>(time).count()))
        ->group(kLimitGroup);
  };
  seconds("--receiving-seconds", bounds.receiving_time, "How long a request may take to arrive");
  app.add_option("--connection-age-seconds", config.connection_age_seconds,
                 "When a connection is replaced, streams asked to move, 0 for never; unless told "
                 "3600 with --tls-client-ca, else never")
      ->check(CLI::Range(0.0, kDay))
      ->group(kLimitGroup);
}

void AddKeepalive(CLI::App& app, Config& config) {
  const auto add = [&](const char* name, double& value, const char* help) {
    app.add_option(name, value, help)
        ->capture_default_str()
        ->check(CLI::Range(1.0, kDay))
        ->group(kLimitGroup);
  };
  add("--keepalive-seconds", config.keepalive_seconds,
      "After how much silence a client is asked for a sign of life");
  add("--keepalive-timeout-seconds", config.keepalive_timeout_seconds,
      "How long it may take to give one before it is cut off");
}

void AddCredentials(CLI::App& app, host::CredentialOptions& options) {
  constexpr const char* kGroup = "Who may connect";
  app.add_option("--tls-cert", options.tls.certificate,
                 "Certificate in PEM: TCP addresses speak TLS. Read again when it changes")
      ->group(kGroup);
  app.add_option("--tls-key", options.tls.key, "Its private key in PEM")->group(kGroup);
  app.add_option("--tls-client-ca", options.tls.client_ca,
                 "Authorities of client certificates in PEM; the common name is the owner")
      ->group(kGroup);
  app.add_flag("--require-client-cert", options.tls.require_client_certificate,
               "Refuse connections without a client certificate")
      ->group(kGroup);
  app.add_option("--token-file", options.token_file,
                 "Bearer tokens as `arapctl token` writes them; callers need one (or a client "
                 "certificate). Read again when it changes and at SIGHUP")
      ->group(kGroup);
  app.add_flag(std::string("--") + host::kAllowPlaintextFlag, options.allow_plaintext,
               "Listen beyond this machine without TLS")
      ->group(kGroup);
  app.add_flag(std::string("--") + host::kAllowAnyoneFlag, options.allow_anyone,
               "Listen beyond this machine without asking who is calling")
      ->group(kGroup);
}

void AddStore(CLI::App& app, Config& config) {
  store::StoreOptions& store = config.host.store;
  constexpr const char* kGroup = "Where sessions are kept";
  app.add_option("--store", store.store,
                 "memory, sqlite:DIR, redis://[USER[:PASSWORD]@]HOST[:PORT][/DB], "
                 "redis+sentinel://HOST[:PORT],.../NAME[/DB] or redis+cluster://HOST[:PORT],...; "
                 "rediss for TLS. By default the state directory of the user")
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--redis-password-file", config.redis_password_file,
                 "File with the password of redis, which then is in no command line")
      ->group(kGroup);
  app.add_option("--redis-sentinel-password-file", config.redis_sentinel_password_file,
                 "File with the password of the sentinels, if they have one")
      ->group(kGroup);
  app.add_option("--redis-ca", store.redis.ca,
                 "Authorities of redis in PEM, for rediss; else those of this machine")
      ->group(kGroup);
  app.add_option("--redis-cert", store.redis.certificate,
                 "Certificate in PEM that is shown to redis, for rediss")
      ->group(kGroup);
  app.add_option("--redis-key", store.redis.key, "Its private key in PEM")->group(kGroup);
  app.add_option("--redis-replicas", store.redis.replicas,
                 "Replicas of redis that have to confirm a change before it is acknowledged")
      ->capture_default_str()
      ->check(CLI::Range(0, 16))
      ->group(kGroup);
  app.add_option("--blob-dir", store.blob_dir,
                 "Folder for meshes; DIR/blobs for sqlite, shared by all replicas for redis. With "
                 "--blob-store a cache of this server alone, or none")
      ->group(kGroup);
  app.add_option("--blob-store", store.blob_store,
                 "s3://BUCKET[/PREFIX]: meshes in an S3-compatible object store")
      ->group(kGroup);
  app.add_option("--s3-endpoint", store.s3.endpoint,
                 "https://HOST[:PORT] of the object store; by default Amazon's of the region")
      ->group(kGroup);
  app.add_option("--s3-region", store.s3.region, "Region of the bucket")
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--s3-credentials-file", store.s3.credentials_file,
                 "File with aws_access_key_id = … and aws_secret_access_key = …; without it the "
                 "variables AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY count. Read again for "
                 "every request")
      ->group(kGroup);
  app.add_option("--s3-ca", store.s3.ca,
                 "Authorities of the object store in PEM, else those of this machine")
      ->group(kGroup);
  app.add_option("--s3-cache-bytes", store.s3.cache_bytes,
                 "Bytes of meshes in --blob-dir; those that were used least recently go")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e15))
      ->group(kGroup);
  app.add_flag("--allow-lossy-store", store.allow_lossy,
               "Start also with a Redis that evicts keys or keeps nothing on disk")
      ->group(kGroup);
}

void AddLanes(CLI::App& app, app::Lanes& lanes) {
  app.add_option("--workers", lanes.workers, "Threads for deformation")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'024));
  app.add_option("--job-workers", lanes.job_workers,
                 "Threads for registration, compilation, flattening and tracks")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'024));
  app.add_option("--control-workers", lanes.control_workers,
                 "Threads for sessions and look-ups, which may wait for the store")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'024));
}

void AddStopping(CLI::App& app, Config& config) {
  const auto add = [&](const char* name, double& value, double smallest, const char* help) {
    app.add_option(name, value, help)
        ->capture_default_str()
        ->check(CLI::Range(smallest, kDay))
        ->group(kStopping);
  };
  add("--stuck-seconds", config.stuck_seconds, 0.001,
      "How long workers or store may stand still before /readyz says no");
  add("--drain-delay", config.drain_delay_seconds, 0.0,
      "Seconds between SIGTERM, when /readyz says no, and the first call that is refused");
  add("--drain-seconds", config.drain_seconds, 0.0,
      "How long running calls may go on after the delay");
}

void AddLogs(CLI::App& app, Config& config) {
  app.add_option("--admin", config.host.admin,
                 "Address of /metrics, /healthz and /readyz, host:port (port 0: any free one)")
      ->capture_default_str()
      ->group(kLogs);
  app.add_flag("--no-admin", config.no_admin, "Serve no such page")->group(kLogs);
  app.add_option("--log-level", config.log.level, "What goes into the log")
      ->capture_default_str()
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->group(kLogs);
  app.add_option("--log-file", config.log.file, "Log into this file and not to standard error")
      ->group(kLogs);
  app.add_option("--access-log", config.log.access,
                 "A line per RPC into this file; - for the log (calls that are quick or many at "
                 "level debug only), off for none")
      ->capture_default_str()
      ->group(kLogs);
  app.add_option("--log-max-bytes", config.log.max_bytes,
                 "Begin a new file when one has this many bytes")
      ->capture_default_str()
      ->check(CLI::Range(1'024.0, 1e12))
      ->group(kLogs);
  app.add_option("--log-files", config.log.files, "How many old files to keep of each log")
      ->capture_default_str()
      ->check(CLI::Range(0, 1'000))
      ->group(kLogs);
}

}  // namespace

void AddFlags(CLI::App& app, Config& config) {
  app.add_option("--listen", config.host.listen,
                 "Address to listen on, host:port (port 0: any free one) or unix:PATH; repeatable")
      ->capture_default_str()
      ->allow_extra_args(false);
  app.add_option("--socket-mode", config.socket_mode, "Mode of unix sockets, in octal")
      ->capture_default_str();
  AddLanes(app, config.host.lanes);
  app.add_flag("--reflection,!--no-reflection", config.host.reflection,
               "Serve the descriptions of the services (by default only where nobody but this "
               "machine reaches the server)");
  app.add_flag("--echo,!--no-echo", config.host.echo,
               "Serve EchoService, which answers bytes with bytes, for arapctl load --transport");
  AddCredentials(app, config.host.credentials);
  AddStore(app, config);
  AddStopping(app, config);
  AddLogs(app, config);
  AddLimits(app, config);
  AddConnections(app, config);
  AddKeepalive(app, config);
  app.add_flag("--check-config", config.check,
               "Check flags, environment and file, say what is wrong, and end: 0 or 2")
      ->configurable(false);
  app.set_version_flag("--version", std::string("arapd ") + app::Version());
}

}  // namespace arap::config
