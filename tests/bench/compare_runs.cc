#include "tests/bench/compare_runs.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

bool IsDuration(std::string_view figure) {
  return figure.ends_with("_us") || figure.ends_with("_ms");
}

// Those that are not ours stand for the machine. So does the floor, a plain reading of memory.
bool IsOfOthers(std::string_view figure) {
  return figure.starts_with("paper_") || figure.starts_with("cgal_") || figure == "floor_us";
}

bool IsMeasured(std::string_view figure) {
  return IsDuration(figure) || figure.ends_with("_bytes");
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

bool Comparison::regressed() const {
  return std::ranges::any_of(changes, [](const Change& change) { return change.regression; });
}

Comparison CompareRuns(const Json& before, const Json& now) {
  Comparison comparison;
  std::vector<double> others;
  for (const auto& [section, sizes] : before.items()) {
    for (const auto& [size, figures] : sizes.items()) {
      for (const auto& [figure, value] : figures.items()) {
        if (!IsMeasured(figure) || !value.is_number() || value.get<double>() <= 0) continue;
        const std::string name = section + "." + size + "." + figure;
        const nlohmann::json::json_pointer where("/" + section + "/" + size + "/" + figure);
        if (!now.contains(where) || !now[where].is_number()) {
          // A run may have measured less: a size or a section that it left out is no loss.
          if (now.contains(where.parent_pointer())) comparison.missing.push_back(name);
          continue;
        }
        const double old_value = value.get<double>(), new_value = now[where].get<double>();
        if (!IsOfOthers(figure)) {
          comparison.changes.push_back({name, old_value, new_value, new_value / old_value, false});
        } else if (IsDuration(figure)) {
          others.push_back(new_value / old_value);
        }
      }
    }
  }
  if (!others.empty()) comparison.machine = Median(others);
  for (Change& change : comparison.changes) {
    if (IsDuration(change.name)) change.factor /= comparison.machine;
    change.regression = change.factor > 1 + kNoise;
  }
  return comparison;
}

void PrintComparison(const Comparison& comparison) {
  fmt::print("\nbeside the run before; this machine took {:.2f} times as long for the others\n",
             comparison.machine);
  fmt::print("{:44}{:>14}{:>14}{:>9}\n", "", "before", "now", "factor");
  for (const Change& change : comparison.changes) {
    fmt::print("{:44}{:>14.1f}{:>14.1f}{:>9.2f}{}\n", change.name, change.before, change.now,
               change.factor, change.regression ? "  REGRESSION" : "");
  }
  for (const std::string& name : comparison.missing) fmt::print("{:44} is missing now\n", name);
}

}  // namespace arap::bench
