// Engine: everything that the RPCs of one server share.
#pragma once

#include <cstddef>

#include "server/app/flatten_cache.h"
#include "server/app/limits.h"
#include "server/app/mesh_cache.h"
#include "server/app/open_streams.h"
#include "server/app/session_registry.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"
#include "server/runtime/worker_pool.h"

namespace arap::app {

// How much runs at once.
struct Lanes {
  std::size_t workers = 2;      // threads of the interactive lane
  std::size_t job_workers = 1;  // threads of the job lane
  std::size_t queue = 256;      // waiting jobs of each lane
};

// Registering a mesh yields the processor to frames.
inline constexpr int kJobNiceness = 10;

// Thread-safe member by member. Two lanes, so that an upload never delays a drag: deformation and
// quick answers run on `interactive`; registration, compilation, edits, flattening and tracks on
// `jobs`.
struct Engine {
  // `clock` outlives the engine.
  Engine(const Limits& the_limits, const Lanes& lanes, const runtime::Clock& clock)
      : limits(the_limits),
        sessions(limits, clock),
        surfaces(limits.max_cached_surfaces, limits.max_cached_surface_bytes),
        streams(limits.max_streams),
        interactive({"interactive", lanes.workers, lanes.queue, 0, &metrics}),
        jobs({"jobs", lanes.job_workers, lanes.queue, kJobNiceness, &metrics}) {}

  runtime::Metrics metrics;  // first: the others count in it until their end
  const Limits limits;
  SessionRegistry sessions;
  MeshCache meshes;
  FlattenCache surfaces;
  OpenStreams streams;
  // Last, so that no job outlives what it uses.
  runtime::WorkerPool interactive;
  runtime::WorkerPool jobs;
};

}  // namespace arap::app
