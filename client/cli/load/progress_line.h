// How a run goes, on one line of a terminal that is written over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace arap::cli {

struct LoadMoment {
  double seconds = 0;  // since it began
  double of = 0;       // how long it is to take; 0: not known
  bool warming_up = false;
  double rate = 0;           // answers a second lately
  double p50 = 0, p99 = 0;   // of these, in microseconds; 0 where there was none
  std::uint64_t errors = 0;  // since it began
};

// "48 s left  998.5/s  p50 1.23 ms  p99 4.56 ms  errors 0", at most 80 columns.
std::string ProgressText(const LoadMoment& moment);

// Silent unless standard error is a terminal, and `silent` says otherwise. For one thread.
class ProgressLine {
 public:
  explicit ProgressLine(bool silent);
  ~ProgressLine();  // takes the line away
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  bool shows() const { return shows_; }
  void Show(const LoadMoment& moment);

 private:
  bool shows_;
  bool shown_ = false;
};

}  // namespace arap::cli
