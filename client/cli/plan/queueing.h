// A queue in front of a server's workers, simulated: how long updates take when so many come.
#pragma once

#include <cstddef>
#include <cstdint>

namespace arap::cli {

struct QueueInput {
  double rate = 0;          // updates a second
  std::size_t streams = 0;  // that each send evenly; 0: updates come by chance (Poisson)
  std::size_t workers = 1;
  double service = 0;    // seconds of a worker for an update, mean
  double variation = 0;  // standard deviation over mean, of a lognormal distribution
  std::uint64_t seed = 0;
};

// Seconds from the arrival of an update to its end. Without `stable` more comes than the workers
// can do, and the times, which would grow without end, are 0.
struct QueueTimes {
  double utilization = 0;
  bool stable = false;
  double mean = 0, p50 = 0, p90 = 0, p99 = 0;
};

// First come, first served, by whichever worker is free first. Streams begin at times drawn evenly
// from one period. The same input gives the same times; about 200,000 updates are simulated after
// a tenth as many that do not count. O(updates · log workers).
QueueTimes SimulateQueue(const QueueInput& input);

}  // namespace arap::cli
