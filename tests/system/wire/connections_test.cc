// Who may be connected, on real sockets and a clock of the test's.
#include "server/rpc/connections.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "server/host/listen.h"
#include "tests/support/fake_clock.h"
#include "tests/system/wire/peer_address.h"

namespace arap::rpc {
namespace {

using Answer = Connections::Answer;
using host::Descriptor;
using std::chrono::seconds;

class ConnectionsTest : public ::testing::Test {
 protected:
  // A connection from there: both its ends, or none when it is refused.
  Answer Come(const char* address, int port) {
    int ends[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    near_.emplace_back(ends[0]);
    far_.emplace_back(ends[1]);
    return connections_->Admit(ends[0], Peer(address, port));
  }
  // The same over TCP, whose bytes are counted.
  Answer ComeByTcp(const char* address, int port) {
    const Descriptor listener(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_storage own = Peer("127.0.0.1", 0);
    socklen_t size = sizeof(sockaddr_in);
    auto* const name = reinterpret_cast<sockaddr*>(&own);
    EXPECT_EQ(bind(listener.number(), name, size), 0);
    EXPECT_EQ(listen(listener.number(), 1), 0);
    EXPECT_EQ(getsockname(listener.number(), name, &size), 0);
    far_.emplace_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(connect(far_.back().number(), name, size), 0);
    near_.emplace_back(accept4(listener.number(), nullptr, nullptr, SOCK_CLOEXEC));
    return connections_->Admit(near_.back().number(), Peer(address, port));
  }
  void Send(std::size_t i, std::size_t bytes) {
    const std::string zeros(bytes, '\0');
    EXPECT_EQ(send(far_[i].number(), zeros.data(), bytes, MSG_NOSIGNAL), ssize_t(bytes));
  }
  // Calls of strangers, one after the other.
  void CallAsStranger(const char* peer, int calls) {
    for (int i = 0; i < calls; ++i) connections_->Begin(peer, false);
  }
  bool IsCut(std::size_t i) const {
    char byte = 0;
    return recv(far_[i].number(), &byte, 1, 0) == 0;
  }
  void Start(const ConnectionBounds& bounds) { connections_.emplace(bounds, clock_); }

  runtime::FakeClock clock_;
  std::optional<Connections> connections_;
  std::vector<Descriptor> near_, far_;
};

TEST_F(ConnectionsTest, TheOldestUnknownOfAnAddressMakesRoom) {
  Start({.most = 10, .most_per_address = 2});
  EXPECT_EQ(Come("10.0.0.1", 1), Answer::kWelcome);
  connections_->Known("ipv4:10.0.0.1:1");
  EXPECT_EQ(Come("10.0.0.1", 2), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.2", 1), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.1", 3), Answer::kWelcome);
  EXPECT_FALSE(IsCut(0)) << "it is known";
  EXPECT_TRUE(IsCut(1));
  EXPECT_FALSE(IsCut(2)) << "it is of another address";
  connections_->Known("ipv4:10.0.0.1:3");
  EXPECT_EQ(Come("10.0.0.1", 4), Answer::kAddressFull);
  EXPECT_EQ(connections_->count(), 3u);
  EXPECT_EQ(connections_->cut(), 1u);
}

TEST_F(ConnectionsTest, InAllThereAreNoMoreThanTheMost) {
  Start({.most = 2, .most_per_address = 2});
  EXPECT_EQ(Come("10.0.0.1", 1), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.2", 1), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.3", 1), Answer::kWelcome);
  EXPECT_TRUE(IsCut(0));
  connections_->Known("ipv4:10.0.0.2:1");
  connections_->Known("ipv4:10.0.0.3:1");
  EXPECT_EQ(Come("10.0.0.4", 1), Answer::kFull);
}

TEST_F(ConnectionsTest, WhatIsOverIsForgotten) {
  Start({.most = 10, .most_per_address = 10});
  Come("10.0.0.1", 1);
  Come("10.0.0.1", 2);
  near_[0] = Descriptor();
  connections_->Sweep();
  EXPECT_EQ(connections_->count(), 1u);
}

TEST_F(ConnectionsTest, NobodyStaysUnknown) {
  Start({.unknown_time = seconds(60)});
  Come("10.0.0.1", 1);
  Come("10.0.0.1", 2);
  connections_->Known("ipv4:10.0.0.1:2");
  clock_.Advance(seconds(61));
  connections_->Sweep();
  EXPECT_TRUE(IsCut(0));
  EXPECT_FALSE(IsCut(1));
}

TEST_F(ConnectionsTest, WhoeverIsLateIsToldOnce) {
  Start({.most_receiving = 2, .receiving_time = seconds(30)});
  int late = 0;
  const auto told = [&](const Fault& fault) {
    EXPECT_EQ(fault.kind, FaultKind::kDeadlineExceeded);
    ++late;
  };
  auto first = connections_->Receive("ipv4:10.0.0.1:1", told);
  auto second = connections_->Receive("ipv4:10.0.0.1:1", told);
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(connections_->Receive("ipv4:10.0.0.1:1", told)) << "two are the most";
  first->Received(100);
  clock_.Advance(seconds(31));
  connections_->Sweep();
  connections_->Sweep();
  EXPECT_EQ(late, 1);
  EXPECT_TRUE(connections_->Receive("ipv4:10.0.0.1:1", told));
}

TEST_F(ConnectionsTest, CallsThatDoNotEndAsFastAsTheyBeginEndTheirConnection) {
  Start({.most_calls = 2});
  Come("10.0.0.1", 1);
  auto first = connections_->Begin("ipv4:10.0.0.1:1", true);
  auto second = connections_->Begin("ipv4:10.0.0.1:1", true);
  first.reset();
  auto third = connections_->Begin("ipv4:10.0.0.1:1", true);
  EXPECT_FALSE(IsCut(0));
  const auto fourth = connections_->Begin("ipv4:10.0.0.1:1", true);
  EXPECT_TRUE(IsCut(0));
  EXPECT_FALSE(connections_->Begin("ipv4:10.0.0.1:1", true)) << "it is gone";
}

TEST_F(ConnectionsTest, FewerCallsMayBeginWhenMemoryIsShort) {
  bool pressure = false;
  Start({.most_calls = 4, .most_calls_under_pressure = 2});
  connections_->OnPressure([&] { return pressure; });
  Come("10.0.0.1", 1);
  std::vector<std::shared_ptr<const void>> calls;
  for (int i = 0; i < 3; ++i) calls.push_back(connections_->Begin("ipv4:10.0.0.1:1", true));
  EXPECT_FALSE(IsCut(0));
  calls.pop_back();
  pressure = true;
  calls.push_back(connections_->Begin("ipv4:10.0.0.1:1", true));
  EXPECT_TRUE(IsCut(0));
}

TEST_F(ConnectionsTest, WhoIsRefusedTooOftenIsCut) {
  Start({.unknown_calls = 32, .unknown_calls_per_second = 4});
  Come("10.0.0.1", 1);
  CallAsStranger("ipv4:10.0.0.1:1", 32);
  clock_.Advance(seconds(2));
  CallAsStranger("ipv4:10.0.0.1:1", 8);
  EXPECT_FALSE(IsCut(0)) << "as many more come with time";
  CallAsStranger("ipv4:10.0.0.1:1", 1);
  EXPECT_TRUE(IsCut(0));
  EXPECT_EQ(connections_->cut(), 1u);
}

TEST_F(ConnectionsTest, WhatWasRefusedIsForgivenToWhomeverIsLetIn) {
  Start({.unknown_calls = 32, .unknown_calls_per_second = 1});
  Come("10.0.0.1", 1);
  for (int round = 0; round < 10; ++round) {
    CallAsStranger("ipv4:10.0.0.1:1", 32);
    connections_->Known("ipv4:10.0.0.1:1");
  }
  // Many come through one gateway: strangers do not end the calls of the others.
  auto open = connections_->Begin("ipv4:10.0.0.1:1", true);
  CallAsStranger("ipv4:10.0.0.1:1", 1'000);
  EXPECT_FALSE(IsCut(0));
  open.reset();
  CallAsStranger("ipv4:10.0.0.1:1", 1);
  EXPECT_TRUE(IsCut(0));
}

TEST_F(ConnectionsTest, NewOnesOfAnAddressComeInOneAfterTheOther) {
  Start({.arrivals_at_once = 3, .arrivals_per_second = 10});
  for (int port = 1; port <= 3; ++port) EXPECT_EQ(Come("10.0.0.1", port), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.1", 4), Answer::kSoon);
  EXPECT_EQ(Come("10.0.0.2", 1), Answer::kWelcome) << "it is another address";
  clock_.Advance(std::chrono::milliseconds(100));
  EXPECT_EQ(Come("10.0.0.1", 4), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.1", 5), Answer::kSoon);
  // It is not forgotten with the last connection: who closes and comes back gains nothing.
  for (Descriptor& near : near_) near = Descriptor();
  connections_->Sweep();
  EXPECT_EQ(connections_->count(), 0u);
  EXPECT_EQ(Come("10.0.0.1", 6), Answer::kSoon);
}

TEST_F(ConnectionsTest, WithoutBoundsForStrangersNewOnesComeAsTheyCome) {
  Start({.arrivals_at_once = 1, .arrivals_per_second = 1, .unknown_calls = 0});
  for (int port = 1; port <= 9; ++port) EXPECT_EQ(Come("10.0.0.1", port), Answer::kWelcome);
}

TEST_F(ConnectionsTest, AnAddressWhoseStrangersWereCutIsOnProbation) {
  Start({.unknown_calls = 32,
         .unknown_calls_per_second = 1,
         .probation = seconds(30),
         .probation_connections_per_second = 2});
  Come("10.0.0.1", 1);
  Come("10.0.0.1", 2);
  connections_->Known("ipv4:10.0.0.1:2");
  Come("10.0.0.1", 3);
  CallAsStranger("ipv4:10.0.0.1:3", 2);
  Come("10.0.0.1", 4);
  CallAsStranger("ipv4:10.0.0.1:4", 33);
  EXPECT_TRUE(IsCut(3));
  EXPECT_FALSE(IsCut(1)) << "it is known";
  CallAsStranger("ipv4:10.0.0.1:2", 32);
  EXPECT_FALSE(IsCut(1)) << "as before";
  EXPECT_FALSE(IsCut(2)) << "it has asked for little";
  CallAsStranger("ipv4:10.0.0.1:3", 1);
  EXPECT_TRUE(IsCut(2)) << "a sixteenth is allowed now";

  EXPECT_EQ(Come("10.0.0.1", 5), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.1", 6), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.1", 7), Answer::kLater);
  EXPECT_EQ(Come("10.0.0.2", 1), Answer::kWelcome) << "it is another address";
  clock_.Advance(std::chrono::milliseconds(500));
  EXPECT_EQ(Come("10.0.0.1", 7), Answer::kWelcome);
  EXPECT_EQ(Come("10.0.0.1", 8), Answer::kLater);
  clock_.Advance(seconds(30));
  for (int port = 10; port < 20; ++port) EXPECT_EQ(Come("10.0.0.1", port), Answer::kWelcome);
}

TEST_F(ConnectionsTest, WhoSendsTooMuchBeforeTheyAreKnownIsCut) {
  Start({.unknown_bytes = 64'000});
  EXPECT_EQ(ComeByTcp("10.0.0.1", 1), Answer::kWelcome);
  EXPECT_EQ(ComeByTcp("10.0.0.2", 1), Answer::kWelcome);
  connections_->Known("ipv4:10.0.0.2:1");
  EXPECT_EQ(ComeByTcp("10.0.0.3", 1), Answer::kWelcome);
  Send(0, 64'001);
  Send(1, 64'001);
  Send(2, 64'000);
  connections_->Sweep();
  EXPECT_TRUE(IsCut(0));
  EXPECT_EQ(connections_->count(), 2u);
  char byte = 0;
  EXPECT_EQ(recv(near_[0].number(), &byte, 1, MSG_DONTWAIT), 0) << "it is not to be read any more";
  // The next one of this address may send a sixteenth before it is let in.
  EXPECT_EQ(ComeByTcp("10.0.0.1", 2), Answer::kWelcome);
  Send(3, 4'001);
  EXPECT_EQ(connections_->Admit(near_[3].number(), Peer("10.0.0.1", 3)), Answer::kGreedy);
}

TEST_F(ConnectionsTest, SaysHowMuchItHoldsOfHalfRequests) {
  Start({});
  std::vector<std::size_t> told;
  connections_->OnReceiving([&](std::size_t bytes) { told.push_back(bytes); });
  EXPECT_EQ(ComeByTcp("10.0.0.1", 1), Answer::kWelcome);
  connections_->Known("ipv4:10.0.0.1:1");
  auto request = connections_->Receive("ipv4:10.0.0.1:1", [](const Fault&) {});
  ASSERT_TRUE(request);
  Send(0, 1'000);
  connections_->Sweep();
  EXPECT_TRUE(told.empty()) << "it is little";
  std::size_t sent = 1'000;
  while (sent < (std::size_t{9} << 20u)) {
    Send(0, 4'096);
    sent += 4'096;
    std::array<char, 4'096> here{};
    EXPECT_GT(recv(near_[0].number(), here.data(), here.size(), 0), 0);
  }
  connections_->Sweep();
  EXPECT_EQ(told, std::vector<std::size_t>{std::size_t{8} << 20u});
  request->Received(sent);
  connections_->Sweep();
  EXPECT_EQ(told.back(), 0u);
}

TEST_F(ConnectionsTest, LooksOftenWhileStrangersAreIn) {
  Start({});
  EXPECT_EQ(connections_->Pause(), seconds(1));
  Come("10.0.0.1", 1);
  EXPECT_LT(connections_->Pause(), std::chrono::milliseconds(100));
  connections_->Known("ipv4:10.0.0.1:1");
  EXPECT_EQ(connections_->Pause(), seconds(1));
}

TEST_F(ConnectionsTest, OldConnectionsAreLeft) {
  Start({.most_age = seconds(100)});
  Come("10.0.0.1", 1);
  clock_.Advance(seconds(60));
  Come("10.0.0.1", 2);
  int old = 0, young = 0;
  const auto first = connections_->WatchAge("ipv4:10.0.0.1:1", [&](const Fault& fault) {
    EXPECT_EQ(fault.kind, FaultKind::kDraining);
    ++old;
  });
  const auto second = connections_->WatchAge("ipv4:10.0.0.1:2", [&](const Fault&) { ++young; });
  clock_.Advance(seconds(52));
  connections_->Sweep();
  EXPECT_EQ(old, 1);
  EXPECT_EQ(young, 0);
}

}  // namespace
}  // namespace arap::rpc
