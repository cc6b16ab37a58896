#include "tests/system/cluster/cluster.h"

#include <fstream>
#include <sstream>
#include <utility>

#include <gtest/gtest.h>

namespace arap::cluster {
namespace {

constexpr std::chrono::minutes kPatience{2};

std::string ReadFile(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

}  // namespace

Cluster::Cluster(std::size_t servers, std::vector<std::string> flags)
    : servers_(servers), flags_(std::move(flags)) {}

std::vector<std::string> Cluster::Words() const {
  return {"/usr/bin/env", std::string("ARAPD=") + ARAPD, "ARAP_CLUSTER=" + folder_ / "c",
          CLUSTER_SCRIPT};
}

bool Cluster::Start() {
  std::vector<std::string> words = Words();
  // A machine that is busy with other tests makes frames slow, for which no stream is to be refused
  // and no server is to give itself up.
  words.insert(words.end(), {std::to_string(servers_), "--flag=--max-stream-load", "--flag=0",
                             "--flag=--stuck-seconds", "--flag=60"});
  for (const std::string& flag : flags_) words.push_back("--flag=" + flag);
  if (!process_.Launch(words, folder_ / "stderr")) return false;
  const auto address = process_.ReadLine("cluster at ", kPatience);
  if (!address) {
    ADD_FAILURE() << "the cluster does not start: " << ReadFile(folder_ / "stderr");
    return false;
  }
  address_ = *address;
  return true;
}

std::string Cluster::Do(const std::string& verb, const std::string& member) {
  std::vector<std::string> words = Words();
  words.push_back(verb);
  if (!member.empty()) words.push_back(member);
  fault::ChildProcess command;
  if (!command.Launch(words, folder_ / "stderr")) return {};
  std::string said = command.ReadLine("", kPatience).value_or("");
  EXPECT_EQ(command.Wait(kPatience), 0)
      << verb << ' ' << member << ": " << said << ReadFile(folder_ / "stderr");
  return said;
}

std::string Cluster::Log(const std::string& member) const {
  return ReadFile(folder_ / ("c/" + member + ".log"));
}

}  // namespace arap::cluster
