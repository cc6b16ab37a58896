// Reading shapes.csv.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace arap::cli {

struct Csv {
  std::string header;
  std::vector<std::size_t> frames;        // the first column
  std::vector<std::vector<double>> rows;  // the others; NaN where it says nan
};

Csv ParseCsv(std::string_view text);

}  // namespace arap::cli
