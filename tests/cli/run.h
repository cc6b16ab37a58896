// Runs the real arapctl, and a folder for what it writes.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace arap::cli {

struct Outcome {
  int code = -1;  // exit code; 128 + signal when a signal ended it
  std::string out;
  std::string err;
};

Outcome Arapctl(const std::vector<std::string>& arguments);

// The text of a file; a failure of the test when it cannot be read.
std::string Slurp(const std::string& path);

// A fresh folder, gone after the test.
class FolderTest : public testing::Test {
 public:
  FolderTest();
  ~FolderTest() override;

 protected:
  std::string Path(const std::string& name) const { return folder_ + "/" + name; }
  // Writes a file in the folder; answers its path.
  std::string Put(const std::string& name, const std::string& text) const;

 private:
  std::string folder_;
};

}  // namespace arap::cli
