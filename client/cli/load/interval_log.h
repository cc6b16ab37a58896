// How a run goes over time, while it goes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/cli/load/results.h"

namespace arap::cli {

// Cuts a run into intervals of a second. When there are more than kMost they are made twice as long and
// joined by twos, so that a run of any length has between half of kMost and kMost, and memory is bounded:
// a histogram for each of them and each operation that has any. Times are seconds since the run began;
// what is before that counts in the first interval. Not for several threads at once: give each its own
// and Merge them.
class IntervalLog {
 public:
  static constexpr std::size_t kMost = 240;

  // One was due to be sent at `at`; it was sent late, not at all, or replaced by a newer one.
  void Offered(Operation operation, double at);
  void Late(Operation operation, double at);
  void Unsent(Operation operation, double at);
  void Replaced(Operation operation, double at);
  // One was answered at `at`, so many microseconds after it was due.
  void Answered(Operation operation, double at, double micros);
  void Failed(Operation operation, double at);
  void Merge(const IntervalLog& other);

  // All of them up to `end`, when the run ended, also those in which nothing happened. The last has half
  // to one and a half times the length of the others, if there are any, and what came after `end` too.
  std::vector<Interval> Intervals(double end) const;

 private:
  struct Cell {
    std::uint64_t offered = 0, failed = 0, late = 0, unsent = 0, replaced = 0;
    Histogram response;
  };
  using Cells = PerOperation<Cell>;

  static void Add(const Cells& from, Cells& to);
  Cell& At(Operation operation, double at);
  void Double();

  double length_ = 1;  // of an interval, in seconds
  std::vector<Cells> cells_;
};

}  // namespace arap::cli
