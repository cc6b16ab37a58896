// Runs the real arapctl, and reads the shapes that it writes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace arap::cli {

struct Outcome {
  int code = -1;  // exit code; 128 + signal when a signal ended it
  std::string out;
  std::string err;
};

// With `input` on its standard input. Its end is waited for, five minutes at most; then it is killed, and
// the test fails.
Outcome Arapctl(const std::vector<std::string>& arguments, std::string_view input = {});

// The text of a file; a failure of the test when it cannot be read.
std::string Slurp(const std::string& path);

// What shapes.csv holds.
struct Csv {
  std::string header;
  std::vector<std::size_t> frames;        // the first column
  std::vector<std::vector<double>> rows;  // the others; NaN where it says nan
};

Csv ParseCsv(std::string_view text);

}  // namespace arap::cli
