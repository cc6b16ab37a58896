#include "server/engine.h"

#include <algorithm>
#include <string_view>
#include <thread>
#include <utility>

#include "core/base/try.h"
#include "server/runtime/metrics.h"
#include "server/runtime/time_slice.h"

namespace arap::app {
namespace {

namespace metric = runtime::metric;
using Kind = runtime::Metrics::Kind;
using std::chrono::seconds;

constexpr seconds kCollectEvery{60};

// What has a place of its own in the lane: such work waits at most for one of its kind.
constexpr double kShortFrameSeconds = 0.005;
constexpr double kShortJobSeconds = 0.05;
// What the thread that has read an update may compute itself, and how many threads of gRPC's at once: it
// has half as many as processors, 2 to 16 (CallbackAlternativeCQ in its 1.51), and at most half of
// those compute, so that messages of others are read meanwhile.
constexpr double kVisitSeconds = 400e-6;
std::size_t Visitors() {
  return std::clamp<std::size_t>(std::thread::hardware_concurrency() / 4, 1, 8);
}
// Long jobs that may stand aside at once, with all the memory that they have asked for.
constexpr std::size_t kJobsAside = 8;

void WatchLane(runtime::Metrics& metrics, const runtime::WorkerPool& pool) {
  const runtime::Metrics::Labels labels{{"lane", pool.name()}};
  const auto watch = [&](const runtime::MetricInfo& info, Kind kind, auto value) {
    metrics.Watch(info, kind, labels, [&pool, value] { return value(pool.stats()); });
  };
  using Stats = runtime::PoolStats;
  watch(metric::kQueueLength, Kind::kGauge,
        [](const Stats& stats) { return static_cast<double>(stats.waiting); });
  watch(metric::kJobsRunning, Kind::kGauge,
        [](const Stats& stats) { return static_cast<double>(stats.running); });
  watch(metric::kJobs, Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.completed); });
  watch(metric::kTakenAlong, Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.taken_along); });
  watch(metric::kGaveWay, Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.gave_way); });
  watch(metric::kHelpedParts, Kind::kCounter,
        [](const Stats& stats) { return static_cast<double>(stats.helped); });
  watch(metric::kBusySeconds, Kind::kCounter,
        [](const Stats& stats) { return stats.busy.count(); });
  watch(metric::kOldestJobSeconds, Kind::kGauge,
        [](const Stats& stats) { return stats.oldest_running.count(); });
  metrics.Watch(metric::kWorkers, Kind::kGauge, labels,
                [&pool] { return static_cast<double>(pool.threads()); });
}

// Serves lanes, streams, and what the caches hold.
void Watch(Engine& engine) {
  runtime::Metrics& metrics = engine.metrics;
  metrics.Watch(metric::kBuildInfo, Kind::kGauge, {{"version", Version()}}, [] { return 1.0; });
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
  for (const DerivedKind kind :
       {DerivedKind::kMesh, DerivedKind::kHandleSet, DerivedKind::kSurface}) {
    metrics.ServeCache(NameOf(kind));
    const runtime::Metrics::Labels labels{{"kind", NameOf(kind)}};
    metrics.Watch(metric::kBytes, Kind::kGauge, labels,
                  [&engine, kind] { return static_cast<double>(engine.derived.bytes(kind)); });
    metrics.Watch(metric::kEntries, Kind::kGauge, labels,
                  [&engine, kind] { return static_cast<double>(engine.derived.entries(kind)); });
  }
  metrics.Watch(metric::kAccountedBytes, Kind::kGauge, {},
                [&engine] { return static_cast<double>(engine.derived.bytes()); });
}

}  // namespace

const char* Version() { return ARAP_VERSION; }

Engine::Engine(const Limits& the_limits, const Lanes& the_lanes, const runtime::Clock& the_clock,
               store::Stores the_stores)
    : Workshop(the_limits, the_clock, std::move(the_stores)),
      lanes(the_lanes),
      surfaces(derived, metrics, {limits.max_vertices, limits.max_triangles}),
      flatten_jobs(*this, jobs),
      streams(limits.max_streams),
      admission(limits.max_stream_load, static_cast<double>(lanes.workers)),
      registrations("max_registrations", limits.max_registrations),
      compilations("max_compilations", limits.max_compilations),
      flattenings("max_flattenings", limits.max_flattenings),
      interactive({.name = "interactive",
                   .threads = lanes.workers,
                   .queue = limits.max_queued_jobs,
                   .metrics = &metrics,
                   .short_seconds = kShortFrameSeconds,
                   .visitors = Visitors(),
                   .visit_seconds = kVisitSeconds}),
      control({.name = "control",
               .threads = lanes.control_workers,
               .queue = limits.max_queued_jobs,
               .metrics = &metrics,
               .waits = true}),
      jobs({.name = "jobs",
            .threads = lanes.job_workers,
            .queue = limits.max_queued_jobs,
            .metrics = &metrics,
            .gives_way_to = &interactive,
            .short_seconds = kShortJobSeconds,
            .aside = kJobsAside,
            .turns = runtime::kLongTurns}),
      collected_(clock.SteadyNow()) {
  Watch(*this);
}

Status Engine::Sweep() {
  streams.Sweep(clock.SteadyNow());
  derived.EvictIdle(limits.idle_evict);
  CHECK_OK(sessions.Sweep());
  CHECK_OK(keeper.Look());
  const auto now = clock.SteadyNow();
  if (now - collected_ < kCollectEvery) return {};
  collected_ = now;
  CHECK_OK(keeper.Collect(store::kSweepRules));
  return {};
}

}  // namespace arap::app
