// Engine: everything that the RPCs of one server share.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

#include "arap/model/limits.h"
#include "server/budget/gate.h"
#include "server/flattening/flatten_jobs.h"
#include "server/flattening/prepared_surfaces.h"
#include "server/runtime/clock.h"
#include "server/runtime/worker_pool.h"
#include "server/sessions/workshop.h"
#include "server/store/open_store.h"
#include "server/streams/admission.h"
#include "server/streams/open_streams.h"

namespace arap::app {

// The version of the server, "major.minor.patch".
const char* Version();

// How much runs at once.
struct Lanes {
  std::size_t workers = 2;          // threads of the interactive lane
  std::size_t job_workers = 1;      // threads of the job lane
  std::size_t control_workers = 2;  // threads of the control lane
};

// Thread-safe member by member. Three lanes, so that neither an upload nor a slow disk delays a
// drag. Owners share each in equal parts of its time (runtime/fair_queue.h), and in the lanes that
// compute a place is kept for what is short, beside the workers:
//   interactive  frames and light edits; never waits for the store
//   control      sessions and look-ups: what may wait for the store but computes nothing
//   jobs         registration, compilation, edits, flattening, tracks, long frames, and what was
//                evicted and has to be computed again; between their steps they give way to the
//                interactive lane, and to one another in turn
struct Engine : Workshop {
  // `clock` outlives the engine. Lanes, streams and caches are served by its metrics from now on.
  Engine(const Limits& the_limits, const Lanes& the_lanes, const runtime::Clock& clock,
         store::Stores the_stores);

  // Ends what has expired, evicts what nobody uses, and now and then removes blobs that nothing
  // names. To be called every second or so, from one thread. Answers the store's fault if it
  // failed.
  Status Sweep();

  const Lanes lanes;
  PreparedSurfaces surfaces;
  FlattenJobs flatten_jobs;
  OpenStreams streams;
  Admission admission;
  Gate registrations;
  Gate compilations;
  Gate flattenings;
  // Last, so that no job outlives what it uses.
  runtime::WorkerPool interactive;
  runtime::WorkerPool control;
  runtime::WorkerPool jobs;

 private:
  runtime::Clock::Steady collected_;  // when blobs were; of the thread that sweeps
};

}  // namespace arap::app
