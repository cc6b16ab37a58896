// arapd: signals, logs, wiring. The only file of the server that touches the whole process.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <grpc/grpc.h>
#include <grpc/support/log.h>
#include <poll.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/mutex.h"
#include "core/base/try.h"
#include "server/config/config.h"
#include "server/host/host.h"
#include "server/rpc/rpc_log.h"
#include "server/runtime/time_slice.h"

namespace {

using arap::config::Config;
using arap::config::LogOptions;

constexpr int kBadConfig = 2;
constexpr int kDeaf = 3;
// A signal that is none: nobody is let in any more.
constexpr int kDeafSignal = 255;
// How much longer than --drain-seconds the end may take.
constexpr std::chrono::milliseconds kEnding{1'500};

int Complain(const arap::Fault& fault, int code) {
  std::fprintf(stderr, "arapd: %s\n", fault.message.c_str());
  return code;
}

std::vector<std::string> Environment() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) variables.push_back(*variable);
  return variables;
}

// gRPC's own complaints, in our log.
void LogFromGrpc(gpr_log_func_args* args) {
  spdlog::log(args->severity == GPR_LOG_SEVERITY_ERROR ? spdlog::level::warn : spdlog::level::debug,
              "grpc message=\"{}\"", args->message);
}

// The library throws for a file that it cannot open.
arap::Result<spdlog::sink_ptr> FileSink(const LogOptions& options, const char* flag,
                                        const std::string& path) {
  try {
    return std::make_shared<spdlog::sinks::rotating_file_sink_mt>(path, options.max_bytes,
                                                                  options.files);
  } catch (const spdlog::spdlog_ex& error) {
    return arap::Fail(
        arap::Fault(arap::FaultKind::kInvalidOption, fmt::format("--{}: {}", flag, error.what()))
            .Field(flag));
  }
}

void PutInPlace(const std::shared_ptr<spdlog::logger>& logger, const char* pattern,
                spdlog::level::level_enum level) {
  logger->set_pattern(pattern);
  logger->set_level(level);
  logger->flush_on(spdlog::level::info);
}

// The loggers that the config asks for, in their places.
arap::Status SetUpLogs(const LogOptions& options) {
  spdlog::sink_ptr sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  if (!options.file.empty()) {
    TRY(sink, FileSink(options, "log-file", options.file));
  }
  auto log = std::make_shared<spdlog::logger>("arapd", sink);
  PutInPlace(log, "%Y-%m-%dT%H:%M:%S.%e%z level=%l %v", spdlog::level::from_str(options.level));
  // RPCs go into the log unless they have one of their own.
  if (options.access != "-") {
    const bool off = options.access == "off";
    sink = std::make_shared<spdlog::sinks::null_sink_mt>();
    if (!off) {
      TRY(sink, FileSink(options, "access-log", options.access));
    }
    auto access = std::make_shared<spdlog::logger>(arap::rpc::kAccessLog, sink);
    PutInPlace(access, "%Y-%m-%dT%H:%M:%S.%e%z %v", off ? spdlog::level::off : spdlog::level::info);
    spdlog::register_logger(access);
  }
  spdlog::set_default_logger(log);
  gpr_set_log_function(LogFromGrpc);
  return {};
}

void LogConfig(const arap::config::Outcome& outcome) {
  for (const auto& [name, value, source] : outcome.settings) {
    spdlog::info("event=config name={} value=\"{}\" source={}", name, value, source);
  }
  // An orchestrator may put variables of its own under our prefix: no reason not to start.
  for (const std::string& variable : outcome.unknown) {
    spdlog::warn("event=unknown_variable name={}", variable);
  }
}

// As many descriptors as we may have: every connection is one.
void RaiseDescriptors() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur >= files.rlim_max) return;
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
}

// Passwords in our own command line, which everybody on the machine may read, become stars.
void HidePasswords(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string shown = arap::config::Redacted(argv[i]);
    if (shown == argv[i]) continue;
    // The length stays: there is no other place for it.
    const std::size_t length = std::strlen(argv[i]);
    std::fill(argv[i], argv[i] + length, '*');
    shown.copy(argv[i], std::min(length, shown.size()));
  }
}

// Ends the process when it has not ended by then, whatever holds it up. What was answered is in the
// store, so that nothing is lost.
class LastResort {
 public:
  explicit LastResort(std::chrono::milliseconds patience)
      : end_(std::chrono::steady_clock::now() + patience), thread_([this] { Wait(); }) {}
  ~LastResort() {
    {
      const arap::MutexLock lock(&mutex_);
      ended_ = true;
    }
    wake_.Signal();
    thread_.join();
  }
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

 private:
  void Wait() {
    const arap::MutexLock lock(&mutex_);
    while (!ended_) {
      if (!wake_.WaitUntil(&mutex_, end_) || ended_) continue;
      spdlog::warn("event=stopped_by_force message=\"Work that does not end was left behind.\"");
      spdlog::default_logger()->flush();
      std::_Exit(0);
    }
  }

  const std::chrono::steady_clock::time_point end_;
  arap::Mutex mutex_;
  arap::CondVar wake_;
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

// Signals as bytes in a pipe. Blocking them and waiting would not do: OpenBLAS has threads before
// main begins, which do not block them, and a signal that comes while main is busy would end the
// process there. A handler may run on any thread.
int signal_pipe[2] = {-1, -1};

void PutSignal(int signal) {
  const int before = errno;
  const auto byte = static_cast<unsigned char>(signal);
  // A full pipe has signals enough.
  [[maybe_unused]] const auto written = write(signal_pipe[1], &byte, 1);
  errno = before;
}

bool CatchSignals() {
  if (pipe2(signal_pipe, O_CLOEXEC | O_NONBLOCK) != 0) return false;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, PutSignal);
  std::signal(SIGPIPE, SIG_IGN);
  return true;
}

// The next signal; 0 when none comes within `patience`. A negative one waits for ever.
int NextSignal(std::chrono::milliseconds patience) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + patience;
  for (;;) {
    unsigned char byte = 0;
    if (read(signal_pipe[0], &byte, 1) == 1) return byte;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    if (patience.count() >= 0 && left <= 0) return 0;
    constexpr long long kLongest = 3'600'000;
    pollfd wait{signal_pipe[0], POLLIN, 0};
    poll(&wait, 1,
         patience.count() < 0 ? -1 : static_cast<int>(std::min<long long>(left, kLongest)));
  }
}

// What SIGHUP reads again. A file that cannot be used leaves things as they were.
struct ReloadHook {
  const char* name;
  std::function<arap::Status()> run;
};

void Reload(const std::vector<ReloadHook>& hooks) {
  for (const ReloadHook& hook : hooks) {
    if (const arap::Status done = hook.run(); done) {
      spdlog::info("event=reloaded what={}", hook.name);
    } else {
      spdlog::error("event=reload_failed what={} message=\"{}\"", hook.name, done.error().message);
    }
  }
}

// The first of SIGINT and SIGTERM; SIGHUP reloads meanwhile.
int AwaitStop(const std::vector<ReloadHook>& hooks) {
  int signal = 0;
  while ((signal = NextSignal(std::chrono::milliseconds(-1))) == SIGHUP) Reload(hooks);
  return signal;
}

// Lets load balancers look elsewhere. A second signal cuts it short.
void AwaitDelay(std::chrono::milliseconds delay, const std::vector<ReloadHook>& hooks) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + delay;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() <= 0) return;
    const int signal = NextSignal(left);
    if (signal == SIGHUP) Reload(hooks);
    if (signal == SIGINT || signal == SIGTERM) return;
  }
}

// Makes the parents of the directory of "sqlite:DIR"; nothing for other stores.
arap::Status MakeParents(const std::string& store) {
  constexpr std::string_view kSqlite = "sqlite:";
  if (!store.starts_with(kSqlite)) return {};
  const auto parent = std::filesystem::path(store.substr(kSqlite.size())).parent_path();
  if (parent.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  if (!error) return {};
  return arap::Fail(arap::FaultKind::kStoreUnavailable,
                    "The folder " + parent.string() + " cannot be made: " + error.message() + ".");
}

int Serve(const arap::config::Outcome& outcome, std::optional<LastResort>& last_resort) {
  const Config& config = outcome.config;
  if (const arap::Status ready = SetUpLogs(config.log); !ready) return Complain(ready.error(), 1);
  LogConfig(outcome);
  for (const arap::Status& good :
       {MakeParents(config.host.store.store), arap::config::CheckFolders(config.host.store)}) {
    if (!good) return Complain(good.error(), 1);
  }
  arap::host::HostOptions options = config.host;
  options.on_deaf = [] { PutSignal(kDeafSignal); };
  auto host = arap::host::Host::Start(std::move(options));
  if (!host) {
    spdlog::error("event=start_failed message=\"{}\"", host.error().message);
    return Complain(host.error(), 1);
  }
  for (const std::string& address : (*host)->addresses()) {
    std::printf("arapd listening on %s\n", address.c_str());
  }
  const std::string admin = (*host)->admin_address();
  if (!admin.empty()) std::printf("arapd admin on %s\n", admin.c_str());
  std::fflush(stdout);
  spdlog::info("event=ready version={} admin={}", arap::app::Version(),
               admin.empty() ? "-" : admin);

  const std::vector<ReloadHook> hooks = {
      {"access", [&] { return (*host)->credentials().Reload(); }}};
  const int signal = AwaitStop(hooks);
  if (signal == kDeafSignal) {
    spdlog::critical("event=deaf message=\"Nobody is let in; a new process may help.\"");
  }
  (*host)->AnnounceStop();
  spdlog::info("event=draining signal={} streams={} delay_s={}", signal,
               (*host)->engine().streams.count(), config.drain_delay_seconds);
  if (signal != kDeafSignal) {
    AwaitDelay(arap::config::Milliseconds(config.drain_delay_seconds), hooks);
  }
  spdlog::info("event=stopping streams={} grace_s={}", (*host)->engine().streams.count(),
               config.drain_seconds);
  const auto grace = arap::config::Milliseconds(config.drain_seconds);
  last_resort.emplace(grace + kEnding);
  (*host)->Stop(grace);
  spdlog::info("event=stopped");
  return signal == kDeafSignal ? kDeaf : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (!CatchSignals()) {
    std::perror("arapd");
    return 1;
  }
  // What we make is ours alone: logs, databases, blobs. Sockets have --socket-mode.
  umask(0077);
  // For gRPC's threads and those that compute frames; whoever computes for long asks for longer ones.
  arap::runtime::SetTimeSlice(arap::runtime::kQuickTurns);
  RaiseDescriptors();
  auto outcome = arap::config::Read({argv + 1, argv + argc}, Environment());
  HidePasswords(argc, argv);
  if (!outcome) return Complain(outcome.error(), kBadConfig);
  if (outcome->done) {
    std::fputs(outcome->text.c_str(), stdout);
    return 0;
  }
  if (outcome->config.check) {
    if (const arap::Status good = arap::config::Check(outcome->config); !good) {
      return Complain(good.error(), kBadConfig);
    }
    std::puts("arapd: the configuration is good");
    return 0;
  }
  // The end in order: Serve has stopped whatever answers calls; then gRPC's threads end, which hold
  // on to its library as long as we do; then nobody writes into the logs any more.
  grpc_init();
  std::optional<LastResort> last_resort;
  const int code = Serve(*outcome, last_resort);
  grpc_shutdown_blocking();
  last_resort.reset();
  gpr_set_log_function(nullptr);
  spdlog::shutdown();
  return code;
}
