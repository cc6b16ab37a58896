// A writer that is killed at any moment: what was acknowledged is there.
//
// ARAP_KILL_ROUNDS says how often (12 unless told; 60 and more are asked of a release).
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/token/digest.h"
#include "server/store/open_store.h"
#include "tests/server/store/records.h"
#include "tests/server/store/temp_dir.h"

namespace arap::store {
namespace {

using std::chrono::steady_clock;

constexpr std::uint64_t kSessions = 5;

struct Ack {
  std::uint64_t session = 0;
  std::uint64_t revision = 0;
};

int Rounds() {
  const char* text =
      std::getenv("ARAP_KILL_ROUNDS");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  return text == nullptr ? 12 : std::atoi(text);
}

// The next acknowledgement. False at the end of the pipe, or when none has come for long.
bool ReadAck(int from, Ack& ack) {
  pollfd ready{from, POLLIN, 0};
  constexpr int kPatienceMillis = 60'000;
  return poll(&ready, 1, kPatienceMillis) == 1 &&
         read(from, &ack, sizeof ack) == static_cast<ssize_t>(sizeof ack);
}

Result<Stores> Open(const std::string& directory) {
  StoreOptions options;
  options.store = "sqlite:" + directory;
  return OpenStores(options);
}

std::string Bytes(const Ack& ack) {
  return std::string(5000, 'x') + std::to_string(ack.session) + "/" + std::to_string(ack.revision);
}

SessionRecord RecordOf(const Ack& ack) {
  SessionRecord record = testing::PlainRecord("ann", std::to_string(ack.session));
  record.revision = ack.revision;
  record.created = record.expires = runtime::Clock::Wall(std::chrono::hours(24 * 365 * 80));
  record.labels["revision"] = std::to_string(ack.revision);
  record.meshes["face"].blob = *Sha256Hex(Bytes(ack));
  return record;
}

// Runs until it is killed; a blob goes before the record that names it.
[[noreturn]] void Write(const std::string& directory, std::map<std::uint64_t, std::uint64_t> at,
                        int acknowledge) {
  auto stores = Open(directory);
  for (std::uint64_t i = 0; stores; ++i) {
    const std::uint64_t session = i % kSessions;
    const Ack ack{session, ++at[session]};
    const SessionRecord record = RecordOf(ack);
    if (!stores->blobs->Put(record.meshes.at("face").blob, Bytes(ack))) break;
    auto put = stores->specs->Put(record);
    if (!put || !*put) break;
    if (write(acknowledge, &ack, sizeof ack) != sizeof ack) break;
  }
  _exit(1);
}

TEST(KillTest, WhatWasAcknowledgedIsThere) {
  const testing::TempDir dir;
  const std::string state = dir / "state";
  testing::Random random(31);
  std::map<std::uint64_t, std::uint64_t> at;
  const int rounds = Rounds();
  std::uint64_t total = 0;
  for (int round = 0; round < rounds; ++round) {
    int ends[2] = {};
    ASSERT_EQ(pipe(ends), 0);
    const pid_t writer = fork();
    if (writer == 0) Write(state, at, ends[1]);
    close(ends[1]);
    std::map<std::uint64_t, std::uint64_t> acknowledged = at;
    Ack ack;
    // The kill comes after some acknowledgements and a spin, in the middle of what follows.
    for (std::size_t left = 1 + random.Below(6); left > 0; --left) {
      ASSERT_TRUE(ReadAck(ends[0], ack)) << "waited for the writer in round " << round;
      acknowledged[ack.session] = ack.revision;
    }
    const auto end = steady_clock::now() + std::chrono::microseconds(random.Below(3000));
    while (steady_clock::now() < end) {
    }
    kill(writer, SIGKILL);
    waitpid(writer, nullptr, 0);
    while (ReadAck(ends[0], ack)) acknowledged[ack.session] = ack.revision;
    close(ends[0]);

    auto stores = Open(state);
    ASSERT_TRUE(stores) << stores.error().message;
    EXPECT_FALSE(stores->recovery) << round;
    for (const auto& [session, revision] : acknowledged) {
      const auto record = stores->specs->Load({"ann", std::to_string(session)});
      ASSERT_TRUE(record && *record) << round;
      const std::uint64_t stored = (*record)->revision;
      ASSERT_TRUE(stored == revision || stored == revision + 1) << round;
      ASSERT_EQ(testing::Difference(**record, RecordOf({session, stored})), "");
      ASSERT_TRUE(stores->blobs->Get((*record)->meshes.at("face").blob)) << round;
      total += stored - at[session];
      at[session] = stored;
    }
    // One that was written but not acknowledged.
    for (std::uint64_t session = 0; session < kSessions; ++session) {
      if (at[session] != 0) continue;
      const auto version = stores->specs->Version({"ann", std::to_string(session)});
      ASSERT_TRUE(version);
      if (*version) at[session] = (*version)->revision;
    }
  }
  EXPECT_GE(total, static_cast<std::uint64_t>(rounds));
}

}  // namespace
}  // namespace arap::store
