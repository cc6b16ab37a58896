#include "tests/system/fault/server_process.h"

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
    : program_(ARAPD), flags_(std::move(flags)), listen_(std::move(listen)) {}

std::vector<std::string> ServerProcess::Words() const {
  std::vector<std::string> words = command_;
  words.insert(words.end(), {program_, "--listen", InFolder(listen_, folder_.path())});
  // Unless the test says otherwise. Not in the state directory of whoever runs it; and a machine
  // that is busy with other tests makes frames slow, for which no stream is to be refused.
  for (const auto& [flag, value] :
       {std::pair{"--log-level", "info"}, std::pair{"--store", "memory"},
        std::pair{"--max-stream-load", "0"}}) {
    if (std::find(flags_.begin(), flags_.end(), flag) != flags_.end()) continue;
    words.insert(words.end(), {flag, value});
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

}  // namespace arap::fault
