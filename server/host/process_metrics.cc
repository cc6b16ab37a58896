#include "server/host/process_metrics.h"

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

#include "server/engine.h"
#include "server/version.h"

namespace arap::host {
namespace {

using Kind = runtime::Metrics::Kind;

double ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double OpenDescriptors() {
  double count = -1;  // the one that reads the directory
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc/self/fd", error), end;
       !error && entry != end; entry.increment(error)) {
    ++count;
  }
  return count < 0 ? 0 : count;
}

double MaxDescriptors() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  return static_cast<double>(limit.rlim_cur);
}

double Threads() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double threads = 0;
    if (word == "Threads:" && status >> threads) return threads;
  }
  return 0;
}

double ProcessorSeconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void WatchLane(runtime::Metrics& metrics, const runtime::WorkerPool& pool) {
  const runtime::Metrics::Labels labels{{"lane", pool.name()}};
  const auto watch = [&](const char* name, const char* help, Kind kind, auto value) {
    metrics.Watch(name, help, kind, labels, [&pool, value] { return value(pool.stats()); });
  };
  using Stats = runtime::PoolStats;
  watch("arapd_queue_length", "Jobs that wait for a worker.", Kind::kGauge,
        [](const Stats& stats) { return static_cast<double>(stats.waiting); });
  watch("arapd_jobs_running", "Jobs that run.", Kind::kGauge,
        [](const Stats& stats) { return static_cast<double>(stats.running); });
  watch("arapd_jobs_total", "Jobs that have ended.", Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.completed); });
  watch("arapd_busy_seconds_total", "Time that workers spent on jobs, of all threads.",
        Kind::kCounter, [](const Stats& stats) { return stats.busy.count(); });
  watch("arapd_oldest_job_seconds", "How long the longest running job runs.", Kind::kGauge,
        [](const Stats& stats) { return stats.oldest_running.count(); });
  metrics.Watch("arapd_workers", "Threads.", Kind::kGauge, labels,
                [&pool] { return static_cast<double>(pool.threads()); });
}

}  // namespace

void WatchProcess(runtime::Metrics& metrics) {
  metrics.Watch("arapd_build_info", "Always 1; the version is the label.", Kind::kGauge,
                {{"version", app::Version()}}, [] { return 1.0; });
  metrics.Watch("process_resident_memory_bytes", "Memory in use.", Kind::kGauge, {}, ResidentBytes);
  metrics.Watch("process_open_fds", "Open file descriptors.", Kind::kGauge, {}, OpenDescriptors);
  metrics.Watch("process_max_fds", "File descriptors that may be open.", Kind::kGauge, {},
                MaxDescriptors);
  metrics.Watch("process_threads", "Threads.", Kind::kGauge, {}, Threads);
  metrics.Watch("process_cpu_seconds_total", "Processor time.", Kind::kCounter, {},
                ProcessorSeconds);
  const auto start = static_cast<double>(std::time(nullptr));
  metrics.Watch("process_start_time_seconds", "When the server started, in seconds since 1970.",
                Kind::kGauge, {}, [start] { return start; });
}

void WatchEngine(app::Engine& engine) {
  runtime::Metrics& metrics = engine.metrics;
  for (const runtime::WorkerPool* pool : {&engine.interactive, &engine.control, &engine.jobs}) {
    WatchLane(metrics, *pool);
  }
  metrics.ServeQuota("queue");
  metrics.Watch("arapd_open_streams", "Open streams and running tracks.", Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.streams.count()); });
  metrics.Watch("arapd_sessions", "Sessions in memory.", Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.sessions.in_memory()); });
  for (const app::DerivedKind kind :
       {app::DerivedKind::kMesh, app::DerivedKind::kHandleSet, app::DerivedKind::kSurface}) {
    metrics.ServeCache(app::NameOf(kind));
    const runtime::Metrics::Labels labels{{"kind", app::NameOf(kind)}};
    metrics.Watch("arapd_bytes", "Memory of what was computed and is kept, by kind.", Kind::kGauge,
                  labels,
                  [&engine, kind] { return static_cast<double>(engine.derived.bytes(kind)); });
    metrics.Watch("arapd_entries", "How many of them are kept.", Kind::kGauge, labels,
                  [&engine, kind] { return static_cast<double>(engine.derived.entries(kind)); });
  }
  metrics.Watch("arapd_accounted_bytes",
                "Memory that counts towards max_bytes: what is kept, in use or reserved.",
                Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.derived.bytes()); });
}

}  // namespace arap::host
