// Work in a process of its own, where its peak of memory is its own and where it can be ended.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <nlohmann/json.hpp>

namespace arap::bench {

// What `work` returns, done in a child of this process. Nothing when it takes more than `budget`
// seconds of processor time; aborts with a message when it ends in any other way.
std::optional<nlohmann::ordered_json> RunApart(double budget,
                                               const std::function<nlohmann::ordered_json()>& work);

// How far the memory of this process grows, over what it has when this is made.
class PeakMemory {
 public:
  PeakMemory();
  std::size_t Growth() const;  // bytes

 private:
  std::size_t before_;
};

}  // namespace arap::bench
