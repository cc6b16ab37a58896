// A folder for what a test writes.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include <gtest/gtest.h>

namespace arap {

// A fresh folder, gone after the test.
class FolderTest : public ::testing::Test {
 public:
  FolderTest() {
    std::string pattern = ::testing::TempDir() + "arap-test-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) ADD_FAILURE() << "cannot make " << pattern;
    folder_ = pattern;
  }
  ~FolderTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

 protected:
  std::string Path(const std::string& name) const { return folder_ + "/" + name; }
  // Writes a file in the folder; answers its path.
  std::string Put(const std::string& name, const std::string& text) const {
    std::ofstream file(Path(name), std::ios::binary);
    file << text << std::flush;
    EXPECT_TRUE(file) << "cannot write " << Path(name);
    return Path(name);
  }

 private:
  std::string folder_;
};

}  // namespace arap
