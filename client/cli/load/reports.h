// What a run is told as: text for people at a terminal, when it is over and while it goes, and a table
// for programs that read CSV (text_report.cc); a page for browsers (html_report.cc).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "client/cli/load/results.h"
#include "client/cli/load/threshold.h"

namespace arap::cli {

// At most 80 columns; colours where `descriptor` is a terminal that has them: red for errors and wrong
// answers unless the thresholds let them pass. What these found is not in it (FormatJudgements).
std::string LoadText(const LoadResults& results, int descriptor,
                     std::span<const Judgement> judgements = {});

// A line for each interval and each operation that the run has any of:
// start,seconds,operation,offered,answered,failed,offered_per_second,answered_per_second,p50_micros,
// p99_micros,max_micros
std::string LoadCsv(const LoadResults& results);

// A page that can be sent around: it loads nothing and runs nothing. Latency and rates over time,
// percentiles, rate against latency, errors and settings, as pictures and as tables of the same figures;
// light or dark as the reader has it, from 390 pixels of width on. At most about 200 kB for each
// operation. The same results make the same bytes.
std::string LoadHtml(const LoadResults& results, std::span<const Judgement> judgements);

// The highest of the values in each of `columns` equal parts or fewer, as blocks from low to high:
// "▁▂█". Nothing is a blank. O(values).
std::string Sparkline(const std::vector<double>& values, std::size_t columns);

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

}  // namespace arap::cli
