// The harness itself, and the plainest of the server's promises: it starts, ends and comes again.
#include <csignal>

#include <gtest/gtest.h>

#include "tests/system/fault/client.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

TEST(Harness, StartsServesAndStopsWithCodeZero) {
  ServerProcess server;
  ASSERT_TRUE(server.Start());
  // The client is gone before the end: a connection that stays makes the server wait.
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
  EXPECT_GT(server.ResidentBytes(), std::size_t{1} << 20);
  EXPECT_GT(server.Descriptors(), 3u);
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(std::chrono::seconds(20)), 0);
  EXPECT_NE(server.Log().find("event=stopped"), std::string::npos);
}

TEST(Harness, ListensOnAUnixSocketThatAKilledServerLeftBehind) {
  ServerProcess server({}, "unix:{}/socket");
  ASSERT_TRUE(server.Start());
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
  server.Signal(SIGKILL);
  EXPECT_EQ(server.Wait(std::chrono::seconds(20)), 128 + SIGKILL);
  ASSERT_TRUE(server.Start());
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
}

TEST(Harness, AWrongFlagIsAnExitCodeAndASentence) {
  ServerProcess server({"--workers", "0"});
  const auto code = server.StartAndFail();
  ASSERT_TRUE(code);
  EXPECT_NE(*code, 0);
  EXPECT_NE(server.Log().find("--workers"), std::string::npos) << server.Log();
}

}  // namespace
}  // namespace arap::fault
