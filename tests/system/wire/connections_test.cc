// Who may be connected, on real sockets and a clock of the test's.
#include "server/rpc/connections.h"

#include <atomic>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "server/host/acceptor.h"
#include "server/host/listen.h"
#include "tests/support/bounded.h"
#include "tests/support/fake_clock.h"
#include "tests/support/folder.h"

namespace arap::rpc {
namespace {

using Answer = Connections::Answer;
using host::Descriptor;
using std::chrono::seconds;
using namespace std::string_literals;

sockaddr_storage Peer(const char* address, int port) {
  sockaddr_storage peer{};
  auto& four = reinterpret_cast<sockaddr_in&>(peer);
  four.sin_family = AF_INET;
  four.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address, &four.sin_addr);
  return peer;
}

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
  auto first = connections_->Begin("ipv4:10.0.0.1:1");
  auto second = connections_->Begin("ipv4:10.0.0.1:1");
  first.reset();
  auto third = connections_->Begin("ipv4:10.0.0.1:1");
  EXPECT_FALSE(IsCut(0));
  const auto fourth = connections_->Begin("ipv4:10.0.0.1:1");
  EXPECT_TRUE(IsCut(0));
  EXPECT_FALSE(connections_->Begin("ipv4:10.0.0.1:1")) << "it is gone";
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

class AcceptorTest : public FolderTest {
 protected:
  host::Listening Open(const std::string& address, mode_t mode = 0600) const {
    auto listening = host::Listening::Open(address, host::kForCalls, mode);
    EXPECT_TRUE(listening) << listening.error().message;
    return *std::move(listening);
  }
  std::string Socket() const { return "unix:" + Path("s"); }
  // To "127.0.0.1:PORT".
  static Descriptor Connect(const std::string& address) {
    const int port = std::stoi(address.substr(address.rfind(':') + 1));
    const sockaddr_storage target = Peer("127.0.0.1", port);
    Descriptor peer(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(
        connect(peer.number(), reinterpret_cast<const sockaddr*>(&target), sizeof(sockaddr_in)), 0);
    return peer;
  }
};

TEST_F(AcceptorTest, KnocksAtItsOwnDoorsAndHearsWhenNobodyOpens) {
  runtime::SystemClock clock;
  runtime::Metrics metrics;
  Connections connections({}, clock);
  std::promise<void> opened;
  const std::shared_future<void> open = opened.get_future().share();
  std::atomic<bool> held{false};
  std::string first;
  std::vector<host::Acceptor::Entrance> entrances;
  for (const std::string& address : {"127.0.0.1:0"s, "0.0.0.0:0"s, "localhost:0"s, Socket()}) {
    host::Listening listening = Open(address);
    if (first.empty()) first = listening.address();
    entrances.push_back({std::move(listening), [open, &held](int taken) {
                           held = true;
                           open.wait();
                           close(taken);
                         }});
  }
  host::Acceptor acceptor(std::move(entrances), connections, metrics);
  const Status dialled = acceptor.Dial(testing::kLongest);
  EXPECT_TRUE(dialled) << dialled.error().message;
  EXPECT_EQ(connections.count(), 0u) << "it is no client of itself";
  // Whoever takes the connections does not come back.
  const Descriptor peer = Connect(first);
  EXPECT_TRUE(testing::Await("the door to be held", [&] { return held.load(); }));
  EXPECT_FALSE(acceptor.Dial(std::chrono::milliseconds(100)));
  opened.set_value();
  EXPECT_TRUE(acceptor.Dial(testing::kLongest));
}

TEST_F(AcceptorTest, ASocketOfAnotherServerIsLeftInPlace) {
  {
    std::optional<host::Listening> old = Open(Socket(), 0660);
    EXPECT_EQ(std::filesystem::status(Path("s")).permissions(), std::filesystem::perms(0660));
    EXPECT_FALSE(host::Listening::Open(Socket(), host::kForCalls)) << "somebody listens there";
    std::filesystem::remove(Path("s"));
    const host::Listening successor = Open(Socket());
    old.reset();
    EXPECT_TRUE(std::filesystem::exists(Path("s")));
  }
  EXPECT_FALSE(std::filesystem::exists(Path("s")));
}

}  // namespace
}  // namespace arap::rpc
