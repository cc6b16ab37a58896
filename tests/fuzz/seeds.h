// A folder of first inputs for the fuzz targets.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace arap::fuzz {

class Seeds {
 public:
  explicit Seeds(std::string folder) : folder_(std::move(folder)) {}

  void Put(const std::string& target, const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories(folder_ + "/" + target);
    std::ofstream(folder_ + "/" + target + "/seed_" + name, std::ios::binary) << bytes;
  }

 private:
  std::string folder_;
};

// For the targets that read files.
void PutTexts(const Seeds& seeds);
void PutFiles(const Seeds& seeds);

}  // namespace arap::fuzz
