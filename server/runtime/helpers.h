// Helpers: threads without a job take parts of a job that runs elsewhere.
#pragma once

#include <cstddef>

#include "arap/base/crew.h"
#include "server/runtime/worker_pool.h"

namespace arap::runtime {

// Threads without a job that take parts of a job that runs in this thread: those of the pool that its
// own gives way to. Nobody waits for them but for the end of a part that one has begun, and a thread
// looks for jobs before every part: a job waits for one part at most. What they take of the
// processor is charged to the owner of the job. Jobs of the other pool, those who are helped and their
// helpers are together as many as its threads for long jobs, so that they have a processor each.
class Helpers final : public Crew {
 public:
  // To be used in the thread that makes it, for no longer than its job runs.
  Helpers();
  // Itself; nullptr when there can be no helpers: in a thread of no such pool, or where one thread
  // is all that there should be.
  Crew* crew() { return most_ > 0 ? this : nullptr; }
  // Of the processor, that they have taken.
  double seconds() const { return seconds_; }

 private:
  void RunParts(std::size_t parts, Call call, const void* part) override;

  WorkerPool* pool_ = nullptr;
  std::size_t most_ = 0;
  double seconds_ = 0;
};

}  // namespace arap::runtime
