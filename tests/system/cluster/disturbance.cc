#include "tests/system/cluster/disturbance.h"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/system/fault/client.h"

namespace arap::cluster {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::array<const char*, 5> kKinds{"kill", "freeze", "drain", "restart", "redis"};

void Do(Cluster& cluster, const Disturbance& disturbance, milliseconds length) {
  const std::string& member = disturbance.member;
  if (disturbance.kind == "freeze") {
    cluster.Do("freeze", member);
    Pause(length);
    cluster.Do("thaw", member);
    return;
  }
  if (disturbance.kind == "drain") {
    EXPECT_EQ(cluster.Do("drain", member), member + " ended with 0");
  } else {
    cluster.Do("kill", member);
    if (disturbance.kind == "kill") Pause(length);
  }
  cluster.Do("start", member);
}

double At(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0;
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

void Pause(milliseconds period) {
  const auto end = steady_clock::now() + period;
  fault::Eventually([&] { return steady_clock::now() >= end; }, std::chrono::hours(1));
}

std::vector<Disturbance> Disturb(Cluster& cluster, std::size_t servers, std::chrono::seconds length,
                                 testing::Random& random) {
  std::vector<Disturbance> done;
  std::vector<const char*> kinds;
  const auto end = steady_clock::now() + length;
  while (steady_clock::now() < end) {
    // Everything happens once before anything happens again.
    if (kinds.empty()) {
      kinds.assign(kKinds.begin(), kKinds.end());
      random.Shuffle(kinds);
    }
    const std::string kind = kinds.back();
    kinds.pop_back();
    // Drawn always, so that the seed says the same whatever happens.
    const std::string server = std::to_string(1 + random.Below(servers));
    const auto lasts = milliseconds(500 + random.Below(3500));
    const auto pause = milliseconds(1000 + random.Below(2000));
    Pause(pause);
    const auto at = steady_clock::now();
    done.push_back({kind, kind == "redis" ? kind : server, at, at});
    Do(cluster, done.back(), lasts);
    done.back().over = steady_clock::now();
  }
  Pause(std::chrono::seconds(2));
  return done;
}

std::string Ledger(const std::vector<Disturbance>& disturbances, steady_clock::time_point start,
                   const std::vector<Interruption>& interruptions) {
  // An update was interrupted by the last thing that had happened when its answer came.
  std::map<std::string, std::vector<double>> waits;
  std::map<std::string, std::size_t> times;
  for (const Disturbance& disturbance : disturbances) ++times[disturbance.kind];
  for (const Interruption& interruption : interruptions) {
    const auto answered = interruption.sent + std::chrono::duration<double>(interruption.seconds);
    const auto after = std::find_if(disturbances.begin(), disturbances.end(),
                                    [&](const Disturbance& d) { return d.at > answered; });
    if (after == disturbances.begin()) continue;
    waits[std::prev(after)->kind].push_back(interruption.seconds);
  }
  std::string text;
  const auto since = [&](steady_clock::time_point time) {
    return std::chrono::duration<double>(time - start).count();
  };
  for (const Disturbance& d : disturbances) {
    text += fmt::format("{:7.2f} s to {:7.2f} s  {} {}\n", since(d.at), since(d.over), d.kind,
                        d.member);
  }
  text += fmt::format("{:10} {:>6} {:>12} {:>8} {:>8} {:>8}\n", "what", "times", "interrupted",
                      "p50 s", "p99 s", "worst s");
  for (const auto& [kind, count] : times) {
    std::vector<double>& sorted = waits[kind];
    std::sort(sorted.begin(), sorted.end());
    text += fmt::format("{:10} {:6} {:12} {:8.2f} {:8.2f} {:8.2f}\n", kind, count, sorted.size(),
                        At(sorted, 0.5), At(sorted, 0.99), At(sorted, 1));
  }
  return text;
}

}  // namespace arap::cluster
