// Disturbances: what happens to the members of a cluster, drawn from a seed, and the ledger of it.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "tests/support/random.h"
#include "tests/system/cluster/cluster.h"
#include "tests/system/cluster/drags.h"

namespace arap::cluster {

struct Disturbance {
  std::string kind;    // "kill", "freeze", "drain", "restart", "redis"
  std::string member;  // "1" …, "redis"
  std::chrono::steady_clock::time_point at, over;
};

// Until `length` has passed: one member at a time, so that there is always a server to go on with.
// A server is killed or frozen for up to four seconds, drained and started again, or killed and
// started at once; Redis is killed and started again.
std::vector<Disturbance> Disturb(Cluster& cluster, std::size_t servers, std::chrono::seconds length,
                                 testing::Random& random);

// Waits. Tests wait for conditions; this is how long a disturbance lasts.
void Pause(std::chrono::milliseconds period);

// What happened when, since `start`, and a row for each kind: how often, how many updates were interrupted, and how long: half of them at
// most, 99 of 100, and the longest.
std::string Ledger(const std::vector<Disturbance>& disturbances,
                   std::chrono::steady_clock::time_point start,
                   const std::vector<Interruption>& interruptions);

}  // namespace arap::cluster
