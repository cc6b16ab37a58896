// The logs of the real arapd: a line per RPC, files that begin anew, nothing secret.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/fault/client.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

constexpr std::chrono::seconds kUntilItEnds{30};

std::vector<std::string> Lines(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::string Slurp(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Logs, AccessLogHasOneLinePerRpc) {
  ServerProcess server({"--access-log", "{}/access"});
  ASSERT_TRUE(server.Start());
  {
    FaultClient client(server.address());
    client.SetUp(4);  // CreateSession, RegisterMesh, CompileHandles
    EXPECT_TRUE(
        client.Deform("s", "h", {wire::TargetAt("a", 0, 0), wire::TargetAt("b", 4, 0)}).ok());
    EXPECT_FALSE(client.Deform("secret words\n", "h", {}).ok());
    EXPECT_TRUE(client.Info().ok());
  }
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(kUntilItEnds), 0);
  const std::vector<std::string> lines = Lines(server.folder() / "access");
  ASSERT_EQ(lines.size(), 6u) << Slurp(server.folder() / "access");
  EXPECT_THAT(
      lines,
      Each(MatchesRegex(
          "[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}[.][0-9]{3}[+-][0-9]{2}:[0-9]{2} "
          "rpc=[A-Za-z]+ owner=[A-Za-z0-9_.-]+ session=[^ ]+ "
          "code=[A-Z_]+ ms=[0-9]+[.][0-9]{3}( reason=[A-Z_]+)? request=[0-9a-f]{16}")));
  EXPECT_THAT(lines[0], HasSubstr("rpc=CreateSession owner=anonymous session=s code=OK"));
  EXPECT_THAT(lines[3], HasSubstr("rpc=Deform owner=anonymous session=s code=OK"));
  EXPECT_THAT(lines[4], HasSubstr("session=? code=NOT_FOUND"));
  EXPECT_THAT(lines[4], Not(HasSubstr("secret")));
  EXPECT_THAT(server.Log(), Not(HasSubstr("rpc=CreateSession"))) << "they are in their own file";
}

TEST(Logs, AccessLogCanBeOff) {
  ServerProcess server({"--access-log", "off"});
  ASSERT_TRUE(server.Start());
  EXPECT_TRUE(FaultClient(server.address()).CreateSession("s").ok());
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(kUntilItEnds), 0);
  EXPECT_THAT(server.Log(), Not(HasSubstr("rpc=CreateSession")));
  EXPECT_THAT(server.Log(), HasSubstr("event=stopped"));
}

TEST(Logs, FilesBeginAnewAndOldOnesGo) {
  ServerProcess server({"--log-file", "{}/log", "--access-log", "{}/access", "--log-max-bytes",
                        "2048", "--log-files", "2"});
  ASSERT_TRUE(server.Start());
  {
    FaultClient client(server.address());
    for (int i = 0; i < 200; ++i) EXPECT_TRUE(client.Info().ok());
  }
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(kUntilItEnds), 0);
  for (const char* name : {"access", "log"}) {
    for (const char* suffix : {"", ".1", ".2"}) {
      const std::string path = server.folder() / (std::string(name) + suffix);
      ASSERT_TRUE(std::filesystem::exists(path)) << path;
      EXPECT_LE(std::filesystem::file_size(path), 2048u) << path;
    }
    EXPECT_FALSE(std::filesystem::exists(server.folder() / (std::string(name) + ".3")));
  }
  EXPECT_THAT(Slurp(server.folder() / "log"), HasSubstr("event=stopped"));
  EXPECT_TRUE(server.Log().empty()) << server.Log();
}

}  // namespace
}  // namespace arap::fault
