#include "server/host/process_metrics.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <sys/resource.h>
#include <unistd.h>

#include "server/engine.h"

namespace arap::host {
namespace {

namespace metric = runtime::metric;
using runtime::MetricInfo;
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
  const auto watch = [&](const MetricInfo& info, Kind kind, auto value) {
    metrics.Watch(info, kind, labels, [&pool, value] { return value(pool.stats()); });
  };
  using Stats = runtime::PoolStats;
  watch(metric::kQueueLength, Kind::kGauge,
        [](const Stats& stats) { return static_cast<double>(stats.waiting); });
  watch(metric::kJobsRunning, Kind::kGauge,
        [](const Stats& stats) { return static_cast<double>(stats.running); });
  watch(metric::kJobs, Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.completed); });
  watch(metric::kGaveWay, Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.gave_way); });
  watch(metric::kBusySeconds, Kind::kCounter,
        [](const Stats& stats) { return stats.busy.count(); });
  watch(metric::kOldestJobSeconds, Kind::kGauge,
        [](const Stats& stats) { return stats.oldest_running.count(); });
  metrics.Watch(metric::kWorkers, Kind::kGauge, labels,
                [&pool] { return static_cast<double>(pool.threads()); });
}

}  // namespace

void WatchProcess(runtime::Metrics& metrics) {
  metrics.Watch(metric::kBuildInfo, Kind::kGauge, {{"version", app::Version()}},
                [] { return 1.0; });
  metrics.Watch(metric::kResidentBytes, Kind::kGauge, {}, ResidentBytes);
  metrics.Watch(metric::kOpenDescriptors, Kind::kGauge, {}, OpenDescriptors);
  metrics.Watch(metric::kMaxDescriptors, Kind::kGauge, {}, MaxDescriptors);
  metrics.Watch(metric::kThreads, Kind::kGauge, {}, Threads);
  metrics.Watch(metric::kProcessorSeconds, Kind::kCounter, {}, ProcessorSeconds);
  const auto start = static_cast<double>(std::time(nullptr));
  metrics.Watch(metric::kStartTime, Kind::kGauge, {}, [start] { return start; });
}

void WatchEngine(app::Engine& engine) {
  runtime::Metrics& metrics = engine.metrics;
  for (const runtime::WorkerPool* pool : {&engine.interactive, &engine.control, &engine.jobs}) {
    WatchLane(metrics, *pool);
  }
  metrics.ServeQuota("queue");
  metrics.Watch(metric::kOpenStreams, Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.streams.count()); });
  metrics.Watch(metric::kSessions, Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.sessions.in_memory()); });
  for (const char* reason : store::kWeaknesses) {
    metrics.Watch(metric::kStoreWeakness, Kind::kGauge, {{"reason", reason}}, [&engine, reason] {
      const auto weaknesses = engine.keeper.weaknesses();
      return std::any_of(weaknesses.begin(), weaknesses.end(),
                         [reason](const store::Weakness& weakness) {
                           return std::string_view(weakness.reason) == reason;
                         })
                 ? 1.0
                 : 0.0;
    });
  }
  for (const app::DerivedKind kind :
       {app::DerivedKind::kMesh, app::DerivedKind::kHandleSet, app::DerivedKind::kSurface}) {
    metrics.ServeCache(app::NameOf(kind));
    const runtime::Metrics::Labels labels{{"kind", app::NameOf(kind)}};
    metrics.Watch(metric::kBytes, Kind::kGauge, labels,
                  [&engine, kind] { return static_cast<double>(engine.derived.bytes(kind)); });
    metrics.Watch(metric::kEntries, Kind::kGauge, labels,
                  [&engine, kind] { return static_cast<double>(engine.derived.entries(kind)); });
  }
  metrics.Watch(metric::kAccountedBytes, Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.derived.bytes()); });
}

}  // namespace arap::host
