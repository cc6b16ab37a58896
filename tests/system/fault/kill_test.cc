// kill -9 at random moments: whatever was acknowledged is there afterwards, bit for bit.
//
// ARAP_KILL_ROUNDS says how often (5 unless told; 200 are asked of a release), ARAP_KILL_SEED
// where the dice begin.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>

#include "tests/support/bounded.h"
#include "tests/system/fault/busy_client.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

constexpr std::size_t kClients = 3;

std::uint64_t FromEnvironment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets it
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

TEST(Kill, WhatWasAcknowledgedIsThere) {
  const std::uint64_t seed = FromEnvironment("ARAP_KILL_SEED", 5);
  const std::uint64_t rounds = FromEnvironment("ARAP_KILL_ROUNDS", 5);
  testing::Random random(seed);
  ServerProcess server({"--store", "sqlite:{}/store"});
  std::vector<std::unique_ptr<BusyClient>> clients;
  for (std::size_t i = 0; i < kClients; ++i) {
    clients.push_back(std::make_unique<BusyClient>("c" + std::to_string(i), seed * 100 + i));
  }
  std::size_t acknowledged_in_all = 0;
  for (std::uint64_t round = 0; round <= rounds; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", round " + std::to_string(round));
    ASSERT_TRUE(server.Start());
    {
      FaultClient client(server.address());
      for (const auto& busy : clients) busy->Check(client);
    }
    if (::testing::Test::HasFailure() || round == rounds) break;

    // A moment: after so many answers, and a little more.
    const std::size_t answers = random.Below(60);
    const auto more = static_cast<int>(random.Below(4));
    std::atomic<std::size_t> acknowledged = 0;
    std::vector<testing::BoundedThread> threads;
    for (const auto& busy : clients) {
      threads.emplace_back(
          "the client of a killed server",
          [&busy = *busy, &server, &acknowledged] { busy.Work(server.address(), acknowledged); });
    }
    EXPECT_TRUE(Eventually([&] { return acknowledged >= answers; }));
    poll(nullptr, 0, more);
    server.Signal(SIGKILL);
    EXPECT_EQ(server.Wait(std::chrono::seconds(20)), 128 + SIGKILL);
    threads.clear();
    acknowledged_in_all += acknowledged;
    std::printf("round %llu: killed after %zu answers\n", static_cast<unsigned long long>(round),
                acknowledged.load());
    if (::testing::Test::HasFailure()) break;
  }
  std::printf("%zu calls were acknowledged\n", acknowledged_in_all);
  EXPECT_GT(acknowledged_in_all, rounds);
  if (::testing::Test::HasFailure()) std::printf("%s\n", server.Log().c_str());
}

}  // namespace
}  // namespace arap::fault
