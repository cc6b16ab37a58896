#include "server/config/flags.h"

#include "arap/core/deformer.h"
#include "server/host/listen.h"
#include "server/version.h"

namespace arap::config {
namespace {

constexpr double kMaxSeconds = 1e9;
constexpr double kDay = 86'400;
constexpr const char* kLimits = "Limits";
constexpr const char* kStopping = "Readiness and stopping";
constexpr const char* kLogs = "Logs and metrics";

void AddLimits(CLI::App& app, Config& config) {
  app::Limits& limits = config.host.limits;
  const auto add = [&](const char* name, auto& value, const char* help, double largest = 1e9) {
    app.add_option(name, value, help)
        ->capture_default_str()
        ->check(CLI::Range(0.0, largest))
        ->group(kLimits);
  };
  add("--max-sessions", limits.max_sessions, "Sessions on this server");
  add("--max-meshes-per-session", limits.max_meshes_per_session, "Meshes of one session");
  add("--max-handle-sets-per-session", limits.max_handle_sets_per_session,
      "Handle sets of one session");
  add("--max-vertices", limits.max_vertices, "Vertices of one mesh");
  add("--max-triangles", limits.max_triangles, "Triangles of one mesh");
  add("--max-handles", limits.max_handles, "Handles of one handle set");
  add("--max-message-bytes", limits.max_message_bytes, "Bytes of one request message");
  add("--max-streams", limits.max_streams, "Open streams and running tracks");
  add("--max-track-frames", limits.max_track_frames, "Frames of one track");
  add("--max-refine", limits.max_refine, "Refinement iterations of one update", kMaxRefine);
  add("--max-flatten-triangles", limits.max_flatten_triangles, "Triangles of one flattening");
  add("--max-cached-surfaces", limits.max_cached_surfaces, "Surfaces kept under a surface_key");
  add("--max-cached-surface-bytes", limits.max_cached_surface_bytes,
      "Bytes that the surfaces kept take together", 1e15);
  add("--max-bytes", limits.max_bytes, "Bytes of factors and tables in memory, of all owners",
      1e15);
  add("--max-registrations", limits.max_registrations, "Registrations that run or wait");
  add("--max-compilations", limits.max_compilations, "Compilations and edits that run or wait");
  add("--max-flattenings", limits.max_flattenings, "Flattenings that run or wait");
  add("--max-stream-fps", limits.max_stream_fps,
      "Updates a second on one stream, 0 for any number");
  add("--max-stream-load", limits.max_stream_load,
      "Part of the time of --workers that admitted streams may take, 0 for any", 1.0);
  app::OwnerLimits& owner = limits.owner;
  add("--max-sessions-per-owner", owner.max_sessions, "Sessions of one owner");
  add("--max-meshes-per-owner", owner.max_meshes, "Meshes of one owner, in all sessions");
  add("--max-handle-sets-per-owner", owner.max_handle_sets,
      "Handle sets of one owner, in all sessions");
  add("--max-bytes-per-owner", owner.max_bytes, "Bytes of factors and tables of one owner", 1e15);
  add("--max-streams-per-owner", owner.max_streams, "Open streams and tracks of one owner");
  const auto add_ttl = [&](const char* name, double& value, const char* help,
                           double largest = kMaxSeconds) {
    app.add_option(name, value, help)
        ->capture_default_str()
        ->check(CLI::Range(1.0, largest))
        ->group(kLimits);
  };
  add_ttl("--default-ttl-seconds", config.default_ttl_seconds,
          "How long a session lives without use, unless it says so itself");
  add_ttl("--max-ttl-seconds", config.max_ttl_seconds,
          "How long a session may ask to live without use");
  add_ttl("--max-stream-idle-seconds", config.max_stream_idle_seconds,
          "How long a stream may say nothing");
  add_ttl("--keepalive-seconds", config.keepalive_seconds,
          "After how much silence a client is asked for a sign of life", kDay);
  add_ttl("--keepalive-timeout-seconds", config.keepalive_timeout_seconds,
          "How long it may take to give one before it is cut off", kDay);
  add_ttl("--idle-evict-seconds", config.idle_evict_seconds,
          "When the memory of what nobody uses is given back; it is computed again when needed");
}

void AddAccess(CLI::App& app, host::AccessOptions& access) {
  constexpr const char* kGroup = "Who may connect";
  app.add_option("--tls-cert", access.tls.certificate,
                 "Certificate in PEM: TCP addresses speak TLS. Read again when it changes")
      ->group(kGroup);
  app.add_option("--tls-key", access.tls.key, "Its private key in PEM")->group(kGroup);
  app.add_option("--tls-client-ca", access.tls.client_ca,
                 "Authorities of client certificates in PEM; the common name is the owner")
      ->group(kGroup);
  app.add_flag("--require-client-cert", access.tls.require_client_certificate,
               "Refuse connections without a client certificate")
      ->group(kGroup);
  app.add_option("--token-file", access.token_file,
                 "Bearer tokens as `arapctl token` writes them; callers need one (or a client "
                 "certificate). Read again when it changes and at SIGHUP")
      ->group(kGroup);
  app.add_flag(std::string("--") + host::kAllowPlaintextFlag, access.allow_plaintext,
               "Listen beyond this machine without TLS")
      ->group(kGroup);
  app.add_flag(std::string("--") + host::kAllowAnyoneFlag, access.allow_anyone,
               "Listen beyond this machine without asking who is calling")
      ->group(kGroup);
}

void AddStore(CLI::App& app, store::StoreOptions& store) {
  constexpr const char* kGroup = "Where sessions are kept";
  app.add_option("--store", store.store,
                 "memory, sqlite:DIR, or redis://[:PASSWORD@]HOST[:PORT][/DB]; by default the "
                 "state directory of the user")
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--blob-dir", store.blob_dir,
                 "Folder for meshes; DIR/blobs for sqlite, shared by all replicas for redis")
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
  app.add_option("--queue", lanes.queue, "Jobs that may wait, of each kind")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
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
  AddLanes(app, config.host.lanes);
  app.add_flag("--reflection,!--no-reflection", config.host.reflection,
               "Serve the descriptions of the services (by default only where nobody but this "
               "machine reaches the server)");
  AddAccess(app, config.host.access);
  AddStore(app, config.host.store);
  AddStopping(app, config);
  AddLogs(app, config);
  AddLimits(app, config);
  app.add_flag("--check-config", config.check,
               "Check flags, environment and file, say what is wrong, and end: 0 or 2")
      ->configurable(false);
  app.set_version_flag("--version", std::string("arapd ") + app::Version());
}

}  // namespace arap::config
