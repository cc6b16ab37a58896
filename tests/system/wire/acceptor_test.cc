// The door: who waits at it, who is sent away, and whether it is deaf. On real sockets.
#include "server/host/acceptor.h"

#include <atomic>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/host/listen.h"
#include "tests/support/bounded.h"
#include "tests/support/fake_clock.h"
#include "tests/support/folder.h"
#include "tests/system/wire/peer_address.h"

namespace arap::rpc {
namespace {

using Answer = Connections::Answer;
using host::Descriptor;
using std::chrono::seconds;
using namespace std::string_literals;

class AcceptorTest : public FolderTest {
 protected:
  host::Listening Open(const std::string& address, mode_t mode = 0600) const {
    auto listening = host::Listening::Open(address, host::kForCalls, mode);
    EXPECT_TRUE(listening) << listening.error().message;
    return *std::move(listening);
  }
  // A stranger of this machine who is cut.
  static void Offend(Connections& connections) {
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    const Descriptor near(ends[0]), far(ends[1]);
    ASSERT_EQ(connections.Admit(near.number(), Peer("127.0.0.1", 1)), Answer::kWelcome);
    for (int i = 0; i < 2; ++i) connections.Begin("ipv4:127.0.0.1:1", false);
    ASSERT_EQ(connections.cut(), 1u);
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

TEST_F(AcceptorTest, ConnectionsOfAnAddressOnProbationWaitForTheirTurn) {
  runtime::FakeClock clock;
  runtime::Metrics metrics;
  Connections connections(
      {.unknown_calls = 1, .unknown_calls_per_second = 1e-9, .probation_connections_per_second = 1},
      clock);
  Offend(connections);
  std::vector<Descriptor> in;
  std::atomic<std::size_t> count = 0;
  std::vector<host::Acceptor::Entrance> entrances;
  host::Listening listening = Open("127.0.0.1:0");
  const std::string address = listening.address();
  entrances.push_back({std::move(listening), [&](int taken) {
                         in.emplace_back(taken);
                         ++count;
                       }});
  host::Acceptor acceptor(std::move(entrances), connections, metrics);
  std::vector<Descriptor> peers;
  for (int i = 0; i < 40; ++i) peers.push_back(Connect(address));
  EXPECT_TRUE(testing::Await("the first", [&] { return count == 2; }));
  // Some wait, the others are sent away.
  EXPECT_TRUE(testing::Await("those beyond the places", [&] {
    return metrics.Text().find("{quota=\"address_on_probation\"} 22") != std::string::npos;
  }));
  EXPECT_EQ(count, 2u);
  for (std::size_t i = 3; i <= 18; ++i) {
    clock.Advance(seconds(1));
    EXPECT_TRUE(testing::Await("the next", [&] { return count == i; }));
  }
  acceptor.Stop();
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
