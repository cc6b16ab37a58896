// Runs the real arapctl.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace arap::cli {

struct Outcome {
  int code = -1;  // exit code; 128 + signal when a signal ended it
  std::string out;
  std::string err;
};

Outcome Arapctl(const std::vector<std::string>& arguments);

// The text of a file; a failure of the test when it cannot be read.
std::string Slurp(const std::string& path);

}  // namespace arap::cli
