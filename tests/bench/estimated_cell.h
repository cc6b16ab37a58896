// A piece of work beside what it was estimated to take.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/bench/apart.h"
#include "tests/bench/samples.h"

namespace arap::bench {

// Memory below this is not judged: pages, and what BLAS takes once, are as much.
inline constexpr std::size_t kJudgedBytes = 4'000'000;

// {"estimated_ms", "measured_ms", "estimated_bytes", "measured_bytes"}: processor time and the growth of
// the resident memory, each the least of a few runs, `rounds` at least. What `work`
// returns is destroyed untimed. In a process of its own (RunApart) where memory that others have
// let go is not in the way.
template <class Work>
nlohmann::ordered_json MeasureCell(double milliseconds, std::size_t bytes, Work&& work,
                                   int rounds = 2) {
  Samples samples;
  std::size_t peak = std::numeric_limits<std::size_t>::max();
  Repeat(rounds, 0.4, 7, [&] {
    const PeakMemory memory;
    const auto result = samples.Time(work);
    peak = std::min(peak, memory.Growth());
  });
  return {{"estimated_ms", milliseconds},
          {"measured_ms", samples.Least() * 1e-3},
          {"estimated_bytes", bytes},
          {"measured_bytes", peak}};
}

// A table of cells, a line for each row: estimated over measured, time / memory where that is judged,
// and "–" for a cell that is not there. The cells of a row are {"<column>": cell}.
void PrintEstimatesHead(std::string_view title, const std::vector<std::string>& columns);
void PrintEstimates(const std::string& row, const std::vector<std::string>& columns,
                    const nlohmann::ordered_json& cells);

}  // namespace arap::bench
