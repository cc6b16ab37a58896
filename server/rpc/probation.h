// Probation: the addresses whose strangers asked for too much. For a while new connections of such an
// address come in at a bounded rate, so that who was cut does not simply come back.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include "server/runtime/clock.h"
#include "server/runtime/token_bucket.h"

namespace arap::rpc {

// Not thread-safe. Connections that are in are none of its business.
class Probation {
 public:
  using Time = runtime::Clock::Steady;

  // An address is on probation for `length` after its last offence; until then `rate` connections
  // of it come in each second, two of them at once.
  Probation(std::chrono::milliseconds length, double rate) : length_(length), rate_(rate) {}

  // A stranger of this address asked for too much.
  void Offended(const std::string& address, Time now) {
    if (on_.size() >= kMost && !on_.contains(address)) ForgetOne();
    on_.try_emplace(address, Address{now, runtime::TokenBucket(rate_, kAtOnce, now)})
        .first->second.end = now + length_;
  }

  bool IsOn(const std::string& address, Time now) const {
    const auto found = on_.find(address);
    return found != on_.end() && now < found->second.end;
  }

  // Whether one more connection of the address may come in now; it counts.
  bool LetIn(const std::string& address, Time now) {
    const auto found = on_.find(address);
    if (found == on_.end()) return true;
    if (now < found->second.end) return found->second.connections.Take(now);
    on_.erase(found);
    return true;
  }

 private:
  // Beyond this the one that has the least time left goes: an attacker of many addresses must not
  // fill the memory.
  static constexpr std::size_t kMost = 4'096;
  static constexpr double kAtOnce = 2;

  struct Address {
    Time end;
    runtime::TokenBucket connections;
  };

  void ForgetOne() {
    on_.erase(std::min_element(on_.begin(), on_.end(), [](const auto& a, const auto& b) {
      return a.second.end < b.second.end;
    }));
  }

  const std::chrono::milliseconds length_;
  const double rate_;
  std::map<std::string, Address> on_;
};

}  // namespace arap::rpc
