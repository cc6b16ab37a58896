#include "tests/fault/server_process.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <utility>

#include <gtest/gtest.h>

namespace arap::fault {
namespace {

// A machine that is busy with other tests starts a server slowly.
constexpr std::chrono::seconds kStartTimeout{30};

std::string InFolder(std::string text, const std::string& folder) {
  if (const std::size_t at = text.find("{}"); at != std::string::npos) text.replace(at, 2, folder);
  return text;
}

}  // namespace

ServerProcess::ServerProcess(std::vector<std::string> flags, std::string listen)
    : flags_(std::move(flags)), listen_(std::move(listen)) {}

std::vector<std::string> ServerProcess::Words() const {
  std::vector<std::string> words{ARAPD, "--listen", InFolder(listen_, folder_.path()),
                                 "--log-level", "info"};
  // Not in the state directory of whoever runs the tests.
  if (std::find(flags_.begin(), flags_.end(), "--store") == flags_.end()) {
    words.insert(words.end(), {"--store", "memory"});
  }
  for (const std::string& flag : flags_) words.push_back(InFolder(flag, folder_.path()));
  return words;
}

bool ServerProcess::Start() {
  if (!Launch(Words(), folder_ / "stderr")) return false;
  const auto address = ReadLine("arapd listening on ", kStartTimeout);
  if (address) {
    address_ = *address;
    return true;
  }
  Kill();
  ADD_FAILURE() << "arapd does not listen:\n" << Log();
  return false;
}

std::optional<int> ServerProcess::StartAndFail() {
  if (!Launch(Words(), folder_ / "stderr")) return std::nullopt;
  if (ReadLine("arapd listening on ", kStartTimeout)) {
    Kill();
    return std::nullopt;
  }
  return Wait(kStartTimeout);
}

std::string ServerProcess::Log() const {
  const std::ifstream file(folder_ / "stderr");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool ServerHasFlag(const std::string& flag) {
  const TempFolder folder;
  ChildProcess help;
  if (!help.Launch({ARAPD, "--help"}, folder / "stderr")) return false;
  std::optional<std::string> line;
  do {
    line = help.ReadLine("", kStartTimeout);
  } while (line && line->find(flag + " ") == std::string::npos);
  return line.has_value();
}

}  // namespace arap::fault
