#include "server/engine.h"

#include <utility>

#include "core/base/try.h"

namespace arap::app {
namespace {

using std::chrono::seconds;

// A registration puts its blob before the record that names it: within this time, or the blob is
// taken for left behind.
constexpr seconds kBlobAge{600};
constexpr seconds kCollectEvery{60};

}  // namespace

Engine::Engine(const Limits& the_limits, const Lanes& the_lanes, const runtime::Clock& the_clock,
               store::Stores the_stores)
    : Workshop(the_limits, the_clock, std::move(the_stores)),
      lanes(the_lanes),
      surfaces(derived, metrics, {limits.max_vertices, limits.max_triangles}),
      streams(limits.max_streams),
      load(limits.max_stream_load, static_cast<double>(lanes.workers)),
      registrations("max_registrations", limits.max_registrations),
      compilations("max_compilations", limits.max_compilations),
      flattenings("max_flattenings", limits.max_flattenings),
      interactive({"interactive", lanes.workers, limits.max_queued_jobs, &metrics}),
      control({"control", lanes.control_workers, limits.max_queued_jobs, &metrics}),
      jobs({"jobs", lanes.job_workers, limits.max_queued_jobs, &metrics, &interactive}),
      collected_(clock.SteadyNow()) {}

Status Engine::Sweep() {
  streams.Sweep(clock.SteadyNow());
  load.Look(interactive.stats().busy, clock.SteadyNow());
  derived.EvictIdle(limits.idle_evict);
  CHECK_OK(sessions.Sweep());
  const auto now = clock.SteadyNow();
  if (now - collected_ < kCollectEvery) return {};
  collected_ = now;
  if (auto report = CollectBlobs(kBlobAge); !report) return Fail(report.error());
  return {};
}

}  // namespace arap::app
