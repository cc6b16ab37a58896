// Streams and tracks that are open: how many, whose, and how they are ended together.
#include "server/streams/open_streams.h"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/bounded.h"

namespace arap::app {
namespace {

class FakeCall final : public LongCall {
 public:
  void End(Fault reason) override {
    if (!ended) ended = std::move(reason);
  }
  void Sweep(runtime::Clock::Steady now) override { swept = now; }

  std::optional<Fault> ended;
  std::optional<runtime::Clock::Steady> swept;
};

Caller Owner(const char* name, std::size_t max_streams = 256) {
  Caller caller;
  caller.owner = name;
  caller.limits.max_streams = max_streams;
  return caller;
}

void ExpectQuota(const Status& refused, const char* quota) {
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(refused.error().details.front().second, quota);
}

TEST(OpenStreamsTest, AdmitsSoManyOfAGatewayAndItsUsers) {
  OpenStreams streams(10);
  const auto user = [](const char* name) {
    Caller caller = Owner(name);
    caller.gateway = Gateway{"hub", {}};
    caller.gateway->limits.max_streams = 2;
    return caller;
  };
  std::vector<std::shared_ptr<FakeCall>> calls;
  const auto open = [&](const Caller& caller) {
    calls.push_back(std::make_shared<FakeCall>());
    return streams.Add(calls.back(), caller);
  };
  EXPECT_TRUE(open(Owner("hub2/mia"))) << "the name only begins alike";
  EXPECT_TRUE(open(user("hub/mia")));
  EXPECT_TRUE(open(user("hub")));
  ExpectQuota(open(user("hub/ben")), "max_streams_per_gateway");
  streams.Remove(calls[1].get());
  EXPECT_TRUE(open(user("hub/ben")));
}

TEST(OpenStreamsTest, AdmitsSoManyOfAllOwners) {
  OpenStreams streams(2);
  const auto first = std::make_shared<FakeCall>();
  const auto second = std::make_shared<FakeCall>();
  const auto third = std::make_shared<FakeCall>();
  EXPECT_TRUE(streams.Add(first, Owner("ann")));
  EXPECT_TRUE(streams.Add(second, Owner("bob")));
  ExpectQuota(streams.Add(third, Owner("cas")), "max_streams");
  streams.Remove(third.get());
  EXPECT_EQ(streams.count(), 2u) << "a call that was refused is not there to be removed";
  streams.Remove(first.get());
  EXPECT_TRUE(streams.Add(third, Owner("cas")));
}

TEST(OpenStreamsTest, AdmitsSoManyOfEachOwner) {
  OpenStreams streams(10);
  const auto first = std::make_shared<FakeCall>();
  const auto second = std::make_shared<FakeCall>();
  EXPECT_TRUE(streams.Add(first, Owner("ann", 1)));
  ExpectQuota(streams.Add(second, Owner("ann", 1)), "max_streams_per_owner");
  EXPECT_TRUE(streams.Add(second, Owner("bob", 1))) << "owners share nothing";
  streams.Remove(first.get());
  EXPECT_TRUE(streams.Add(first, Owner("ann", 1)));
}

TEST(OpenStreamsTest, DrainEndsAllAndLetsNobodyIn) {
  OpenStreams streams(10);
  const auto open = std::make_shared<FakeCall>();
  const auto late = std::make_shared<FakeCall>();
  ASSERT_TRUE(streams.Add(open, Owner("ann")));
  streams.Drain();
  ASSERT_TRUE(open->ended.has_value());
  EXPECT_EQ(open->ended->kind, FaultKind::kDraining);
  EXPECT_EQ(open->ended->details.front().first, "resume");
  const Status refused = streams.Add(late, Owner("ann"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kDraining);
  EXPECT_FALSE(late->ended.has_value());
}

TEST(OpenStreamsTest, SweepsThoseThatAreStillThere) {
  OpenStreams streams(10);
  const auto open = std::make_shared<FakeCall>();
  ASSERT_TRUE(streams.Add(open, Owner("ann")));
  ASSERT_TRUE(streams.Add(std::make_shared<FakeCall>(), Owner("ann"))) << "and is gone at once";
  const runtime::Clock::Steady now{std::chrono::seconds(7)};
  streams.Sweep(now);
  EXPECT_EQ(open->swept, now);
}

// Comings and goings beside a drain: whoever got in has been ended.
TEST(OpenStreamsTest, NobodyIsForgottenByADrain) {
  for (int round = 0; round < 50; ++round) {
    OpenStreams streams(1'000);
    std::vector<std::shared_ptr<FakeCall>> admitted;
    testing::BoundedThread comer("the streams that come", [&] {
      for (;;) {
        auto call = std::make_shared<FakeCall>();
        if (!streams.Add(call, Owner("ann", 1'000))) return;
        admitted.push_back(std::move(call));
      }
    });
    streams.Drain();
    comer.Join();
    for (const auto& call : admitted) EXPECT_TRUE(call->ended.has_value());
  }
}

}  // namespace
}  // namespace arap::app
