// arapd: flags, signals, logs, wiring. The only file of the server that touches the whole process.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <grpc/support/log.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "core/deform/deformer.h"
#include "server/app/version.h"
#include "server/host/host.h"
#include "server/host/listen.h"

namespace {

struct Flags {
  arap::host::HostOptions host;
  double drain_seconds = 5;
  double default_ttl_seconds = 3'600;
  double max_ttl_seconds = 86'400;
  std::string log_level = "info";
};

constexpr double kMaxSeconds = 1e9;

std::chrono::milliseconds Milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

void AddLimits(CLI::App& app, Flags& flags) {
  arap::app::Limits& limits = flags.host.limits;
  const auto add = [&](const char* name, auto& value, const char* help, double largest = 1e9) {
    app.add_option(name, value, help)
        ->capture_default_str()
        ->check(CLI::Range(0.0, largest))
        ->group("Limits");
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
  add("--max-refine", limits.max_refine, "Refinement iterations of one update", arap::kMaxRefine);
  add("--max-flatten-triangles", limits.max_flatten_triangles, "Triangles of one flattening");
  add("--max-cached-surfaces", limits.max_cached_surfaces, "Surfaces kept under a surface_key");
  add("--max-cached-surface-bytes", limits.max_cached_surface_bytes,
      "Bytes that the surfaces kept take together", 1e15);
  app.add_option("--default-ttl-seconds", flags.default_ttl_seconds,
                 "How long a session lives without use, unless it says so itself")
      ->capture_default_str()
      ->check(CLI::Range(1.0, kMaxSeconds))
      ->group("Limits");
  app.add_option("--max-ttl-seconds", flags.max_ttl_seconds,
                 "How long a session may ask to live without use")
      ->capture_default_str()
      ->check(CLI::Range(1.0, kMaxSeconds))
      ->group("Limits");
}

void AddAccess(CLI::App& app, arap::host::AccessOptions& access) {
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
  app.add_flag(std::string("--") + arap::host::kAllowPlaintextFlag, access.allow_plaintext,
               "Listen beyond this machine without TLS")
      ->group(kGroup);
  app.add_flag(std::string("--") + arap::host::kAllowAnyoneFlag, access.allow_anyone,
               "Listen beyond this machine without asking who is calling")
      ->group(kGroup);
}

void AddFlags(CLI::App& app, Flags& flags) {
  app.add_option("--listen", flags.host.listen,
                 "Address to listen on, host:port (port 0: any free one) or unix:PATH; repeatable")
      ->capture_default_str()
      ->allow_extra_args(false);
  app.add_option("--workers", flags.host.lanes.workers, "Threads for deformation")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'024));
  app.add_option("--job-workers", flags.host.lanes.job_workers,
                 "Threads for registration, compilation, flattening and tracks")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'024));
  app.add_option("--queue", flags.host.lanes.queue, "Jobs that may wait, of each kind")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  app.add_flag("--reflection,!--no-reflection", flags.host.reflection,
               "Serve the descriptions of the services (by default only where nobody but this "
               "machine reaches the server)");
  app.add_option("--drain-seconds", flags.drain_seconds,
                 "How long running calls may go on after SIGINT or SIGTERM")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 86'400.0));
  app.add_option("--log-level", flags.log_level, "What goes to stderr")
      ->capture_default_str()
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}));
  AddAccess(app, flags.host.access);
  AddLimits(app, flags);
  app.set_version_flag("--version", std::string("arapd ") + arap::app::Version());
}

// gRPC's own complaints, in our log.
void LogFromGrpc(gpr_log_func_args* args) {
  spdlog::log(args->severity == GPR_LOG_SEVERITY_ERROR ? spdlog::level::warn : spdlog::level::debug,
              "grpc message=\"{}\"", args->message);
}

void SetUpLog(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("arapd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e%z level=%l %v");
  spdlog::set_level(spdlog::level::from_str(level));
  gpr_set_log_function(LogFromGrpc);
}

// Blocked before any thread exists, so that only main takes them.
sigset_t BlockSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

}  // namespace

int main(int argc, char** argv) {
  Flags flags;
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  flags.host.lanes = {cores, std::max<std::size_t>(1, cores / 2), 256};
  CLI::App app{"As-rigid-as-possible deformation and flattening as a service.", "arapd"};
  AddFlags(app, flags);
  CLI11_PARSE(app, argc, argv);
  flags.host.limits.max_ttl = Milliseconds(flags.max_ttl_seconds);
  flags.host.limits.default_ttl =
      std::min(Milliseconds(flags.default_ttl_seconds), flags.host.limits.max_ttl);

  const sigset_t signals = BlockSignals();
  SetUpLog(flags.log_level);
  auto host = arap::host::Host::Start(flags.host);
  if (!host) {
    std::fprintf(stderr, "arapd: %s\n", host.error().message.c_str());
    return 1;
  }
  for (const std::string& address : (*host)->addresses()) {
    std::printf("arapd listening on %s\n", address.c_str());
  }
  std::fflush(stdout);
  spdlog::info("event=ready version={} workers={} job_workers={} queue={}", arap::app::Version(),
               flags.host.lanes.workers, flags.host.lanes.job_workers, flags.host.lanes.queue);

  int signal = 0;
  while (sigwait(&signals, &signal) == 0 && signal == SIGHUP) (void)(*host)->access().Reload();
  spdlog::info("event=draining signal={} streams={}", signal, (*host)->engine().streams.count());
  (*host)->Stop(Milliseconds(flags.drain_seconds));
  spdlog::info("event=stopped");
  return 0;
}
