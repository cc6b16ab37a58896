// How the real arapd goes away: not ready first, then streams are told, then the end with code 0.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// A macro of glibc's resolver, and a name that Eigen uses.
#undef _res

#include "tests/system/fault/client.h"
#include "tests/system/fault/server_process.h"
#include "tests/system/wire/http_get.h"

namespace arap::fault {
namespace {

using ::testing::HasSubstr;
using wire::DeformStream;

constexpr std::chrono::seconds kUntilItStops{30};

class StoppingTest : public ::testing::Test {
 protected:
  // Starts it and finds its admin page.
  void Start(ServerProcess& server) {
    ASSERT_TRUE(server.Start());
    const auto admin = server.ReadLine("arapd admin on ", kUntilItStops);
    ASSERT_TRUE(admin);
    admin_ = *admin;
  }
  // The status of a page, 0 when nobody answers.
  int Get(const char* path) const { return wire::HttpGet(admin_, path).status; }

  std::string admin_;
};

TEST_F(StoppingTest, ReadinessGoesFirstThenStreamsThenTheProcess) {
  // The delay ends with a second signal, so the test does not wait for it.
  ServerProcess server({"--drain-delay", "3600", "--drain-seconds", "30"});
  Start(server);
  EXPECT_EQ(Get("/readyz"), 200);
  FaultClient client(server.address());
  client.SetUp(4);
  DeformStream stream(client.deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);

  server.Signal(SIGTERM);
  ASSERT_TRUE(Eventually([&] { return Get("/readyz") == 404; }, kUntilItStops));
  EXPECT_EQ(Get("/healthz"), 200);
  // Everything works: old streams, new ones, new sessions.
  stream.Update(1, {});
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  EXPECT_TRUE(client.CreateSession("late").ok());
  {
    DeformStream late(client.deformation());
    late.Opened("s", "h", v1::DELIVERY_LATEST);
    late.HalfClose();
    EXPECT_FALSE(late.Read().has_value());
    EXPECT_TRUE(late.Finish().ok());
  }
  server.Signal(SIGHUP);  // does not cut the delay short
  EXPECT_TRUE(Eventually(
      [&] { return server.Log().find("event=reloaded what=access") != std::string::npos; },
      kUntilItStops));
  EXPECT_TRUE(client.CreateSession("later").ok());

  server.Signal(SIGTERM);
  EXPECT_FALSE(stream.Read().has_value());
  const wire::WireError moved = wire::ExpectError(stream.Finish(), grpc::UNAVAILABLE, "DRAINING");
  EXPECT_EQ(moved.metadata.at("resume"), "open_again");
  EXPECT_GT(moved.retry_seconds, 0);
  EXPECT_LT(moved.retry_seconds, 10);
  EXPECT_EQ(server.Wait(kUntilItStops), 0);
  EXPECT_THAT(server.Log(), HasSubstr("event=stopped"));
}

TEST_F(StoppingTest, GraceIsBounded) {
  ServerProcess server({"--drain-seconds", "0.1"});
  Start(server);
  FaultClient client(server.address());
  client.SetUp(4);
  // A client that keeps its stream and reads nothing.
  DeformStream stream(client.deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  server.Signal(SIGINT);
  EXPECT_EQ(server.Wait(kUntilItStops), 0);
}

TEST_F(StoppingTest, HangupReloadsAndServesOn) {
  ServerProcess server;
  Start(server);
  server.Signal(SIGHUP);
  EXPECT_TRUE(Eventually(
      [&] { return server.Log().find("event=reloaded what=access") != std::string::npos; },
      kUntilItStops));
  EXPECT_EQ(Get("/readyz"), 200);
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
}

TEST_F(StoppingTest, AdminPageCanBeLeftOut) {
  ServerProcess server({"--no-admin"});
  ASSERT_TRUE(server.Start());
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
  server.Signal(SIGTERM);
  EXPECT_FALSE(server.ReadLine("arapd admin on ", kUntilItStops));
  EXPECT_EQ(server.Wait(kUntilItStops), 0);
}

}  // namespace
}  // namespace arap::fault
