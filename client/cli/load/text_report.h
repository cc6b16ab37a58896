// A run for people at a terminal, and as a table for programs that read CSV.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "client/cli/load/results.h"

namespace arap::cli {

// At most 80 columns; colours where `descriptor` is a terminal that has them.
std::string LoadText(const LoadResults& results, int descriptor);

// A line for each interval and each operation that the run has any of:
// start,seconds,operation,offered,answered,failed,offered_per_second,answered_per_second,p50_micros,
// p99_micros,max_micros
std::string LoadCsv(const LoadResults& results);

// The highest of the values in each of `columns` equal parts or fewer, as blocks from low to high:
// "▁▂█". Nothing is a blank. O(values).
std::string Sparkline(const std::vector<double>& values, std::size_t columns);

}  // namespace arap::cli
