// AwaitedAnswers: which updates and edits of a stream have no answer yet, by which an answer is
// known for one that was asked for.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "arap/base/result.h"

namespace arap::v1 {
class StreamDeformRequest;
}

namespace arap::client::internal {

// Not thread-safe. Answers come in the order of what they answer; with `every` nothing is left out,
// else newer updates may take the place of older ones. Memory: some 40 bytes for each, about
// kMostApart of them unless `every`; older ones are then known as a range only.
class AwaitedAnswers {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMostApart = 4096;

  explicit AwaitedAnswers(bool every) : every_(every) {}

  // An update or an edit goes out.
  void Sent(const v1::StreamDeformRequest& request, Time now);
  // A new call begins, on which these are said first.
  void Restart(std::span<const v1::StreamDeformRequest> messages, Time now);

  // The answer to this sequence came: for how many picks were asked, or nothing when that is not
  // known any more. kInternal when none of that sequence is due.
  Result<std::optional<std::size_t>> Take(std::uint64_t sequence);

  // Since when the oldest waits.
  std::optional<Time> oldest() const;

 private:
  struct Awaited {
    std::uint64_t first = 0, last = 0;  // the same for a single one
    std::optional<std::size_t> picks;
    Time since;
  };

  void Shorten();

  const bool every_;
  std::deque<Awaited> awaited_;
};

}  // namespace arap::client::internal
