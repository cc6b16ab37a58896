#include "tests/bench/estimates_section.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/bench/estimated_cell.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

double EstimatedOver(const Json& cell, const char* estimated, const char* measured) {
  return cell.at(estimated).get<double>() / cell.at(measured).get<double>();
}
double TimeRatio(const Json& cell) { return EstimatedOver(cell, "estimated_ms", "measured_ms"); }
double MemoryRatio(const Json& cell) {
  return EstimatedOver(cell, "estimated_bytes", "measured_bytes");
}

bool IsJudged(const Json& cell) {
  return cell.at("measured_bytes").get<std::size_t>() >= kJudgedBytes;
}

// The cell that is farthest off either way, by the ratio that `ratio` takes of it.
struct Worst {
  std::string where;
  double ratio = 1;

  void Look(const std::string& place, double value) {
    if (where.empty() || std::abs(std::log(value)) > std::abs(std::log(ratio))) {
      where = place;
      ratio = value;
    }
  }
};

}  // namespace

void PrintEstimatesHead(std::string_view title, const std::vector<std::string>& columns) {
  fmt::print(
      "\nestimated over measured, processor time / peak of memory where that is above {} MB\n| {} "
      "|",
      kJudgedBytes / 1'000'000, title);
  for (const std::string& column : columns) fmt::print(" {} |", column);
  fmt::print("\n|---|");
  for (std::size_t i = 0; i < columns.size(); ++i) fmt::print("---|");
  fmt::print("\n");
}

void PrintEstimates(const std::string& row, const std::vector<std::string>& columns,
                    const Json& cells) {
  fmt::print("| {} |", row);
  for (const std::string& column : columns) {
    if (!cells.contains(column)) {
      fmt::print(" – |");
      continue;
    }
    const Json& cell = cells.at(column);
    fmt::print(" {:.1f}", TimeRatio(cell));
    if (IsJudged(cell)) fmt::print(" / {:.1f}", MemoryRatio(cell));
    fmt::print(" |");
  }
  fmt::print("\n");
  std::fflush(stdout);
}

Json MeasureEstimates(bool million) {
  Json all = Json::object();
  Worst time, memory;
  const std::array tables{Json{"deform", MeasureDeformEstimates(million)},
                          Json{"flatten", MeasureFlattenEstimates(million)}};
  for (const Json& table : tables) {
    for (const auto& [row, cells] : table[1].items()) {
      for (const auto& [column, cell] : cells.items()) {
        const std::string place = fmt::format("{}, {}", row, column);
        time.Look(place, TimeRatio(cell));
        if (IsJudged(cell)) memory.Look(place, MemoryRatio(cell));
      }
      all[fmt::format("{} / {}", table[0].get<std::string>(), row)] = cells;
    }
  }
  fmt::print("\nfarthest off: time {:.2f} ({}), memory {:.2f} ({}; of cells above {} MB)\n",
             time.ratio, time.where, memory.ratio, memory.where, kJudgedBytes / 1'000'000);
  return all;
}

}  // namespace arap::bench
