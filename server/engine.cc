#include "server/engine.h"

#include <utility>

#include "core/base/try.h"

namespace arap::app {
namespace {

using std::chrono::seconds;

constexpr seconds kCollectEvery{60};

// What has a place of its own in the lane: such work waits at most for one of its kind.
constexpr double kShortFrameSeconds = 0.005;
constexpr double kShortJobSeconds = 0.05;
// Long jobs that may stand aside at once, with all the memory that they have asked for.
constexpr std::size_t kJobsAside = 8;

}  // namespace

const char* Version() { return ARAP_VERSION; }

Engine::Engine(const Limits& the_limits, const Lanes& the_lanes, const runtime::Clock& the_clock,
               store::Stores the_stores)
    : Workshop(the_limits, the_clock, std::move(the_stores)),
      lanes(the_lanes),
      surfaces(derived, metrics, {limits.max_vertices, limits.max_triangles}),
      streams(limits.max_streams),
      admission(limits.max_stream_load, static_cast<double>(lanes.workers)),
      registrations("max_registrations", limits.max_registrations),
      compilations("max_compilations", limits.max_compilations),
      flattenings("max_flattenings", limits.max_flattenings),
      interactive({.name = "interactive",
                   .threads = lanes.workers,
                   .queue = limits.max_queued_jobs,
                   .metrics = &metrics,
                   .short_seconds = kShortFrameSeconds}),
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
            .aside = kJobsAside}),
      collected_(clock.SteadyNow()) {}

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
