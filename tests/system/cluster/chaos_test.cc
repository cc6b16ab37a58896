// Three servers behind haproxy over one Redis: they are killed, frozen, drained and started again
// while streams drag, sessions come and go, and several clients edit the same handle sets. Nothing
// of that may be seen by those who use the client library, and what they were told must make sense.
//
// ARAP_CHAOS_SECONDS is how long it takes (60 unless told), ARAP_CHAOS_SEED what happens (1);
// script/soak --chaos sets the first. ARAP_CHAOS_LEDGER=FILE takes the ledger too, and FILE.1.log and so on
// what the members have written.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/system/cluster/cluster.h"
#include "tests/system/cluster/disturbance.h"
#include "tests/system/cluster/drags.h"
#include "tests/system/cluster/editors.h"
#include "tests/system/cluster/visitors.h"
#include "tests/system/fault/client.h"

namespace arap::cluster {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::uint64_t FromEnvironment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

void ExpectNoComplaint(const char* whose, const Crowd& crowd) {
  EXPECT_EQ(crowd.complaint_count(), 0u);
  for (const std::string& complaint : crowd.Complaints()) {
    ADD_FAILURE() << whose << ": " << complaint;
  }
}

// All of the streams have gone on to the end, and nobody has complained.
void ExpectGoodEnd(Drags& drags, std::size_t streams) {
  drags.Stop();
  EXPECT_EQ(drags.ended_well(), streams);
  ExpectNoComplaint("a drag", drags);
}

// The call and what happened to its set in the two seconds before its end, and all that was not
// answered.
std::string Before(const std::vector<Call>& history, const Call& call, Call::Time start) {
  std::string text = call.Describe(start);
  for (const Call& other : history) {
    const Call::Time last = other.end.value_or(*call.end);
    if (other.set != call.set || other.begin > *call.end || last < *call.end - seconds(2)) continue;
    text += "\n  " + other.Describe(start);
  }
  return text;
}

// What the histories say; a failure of the test when an answer is not explained.
std::string JudgeAll(const std::vector<std::vector<Call>>& histories, Call::Time start) {
  std::size_t calls = 0, unanswered = 0;
  Planted lost, stale;
  for (const std::vector<Call>& history : histories) {
    const Judgement judgement = Judge(history);
    if (judgement.verdict != Verdict::kExplained) {
      ADD_FAILURE() << (judgement.verdict == Verdict::kWrong ? "not explained: " : "undecided: ")
                    << Before(history, history[judgement.call], start);
    }
    calls += history.size();
    for (const Call& call : history) unanswered += call.end ? 0U : 1U;
    const Planted writes = PlantLostWrites(history), reads = PlantStaleReads(history);
    lost = {lost.planted + writes.planted, lost.found + writes.found};
    stale = {stale.planted + reads.planted, stale.found + reads.found};
  }
  EXPECT_GT(lost.planted, 0u);
  EXPECT_EQ(lost.found, lost.planted);
  EXPECT_EQ(stale.found, stale.planted);
  return fmt::format(
      "{} calls of {} sessions with several editors are explained by one order each, {} edits had "
      "no answer;\nplanted and found: {} of {} lost writes, {} of {} stale reads\n",
      calls, histories.size(), unanswered, lost.found, lost.planted, stale.found, stale.planted);
}

TEST(Chaos, NobodySeesWhatHappensToServersAndNothingIsLost) {
  constexpr std::size_t kServers = 3, kStreams = 60;
  const seconds length(FromEnvironment("ARAP_CHAOS_SECONDS", 60));
  const std::uint64_t seed = FromEnvironment("ARAP_CHAOS_SEED", 1);
  const Puppet puppet = MakePuppet();
  Cluster cluster(kServers);
  ASSERT_TRUE(cluster.Start());

  Drags drags(cluster.address(), puppet, kStreams, milliseconds(100));
  Visitors visitors(cluster.address(), puppet, 4);
  Editors editors(cluster.address(), puppet, 4, seed);
  ASSERT_TRUE(drags.AllMoved(2 * kPatience));
  testing::Random random(seed);
  const auto start = std::chrono::steady_clock::now();
  const auto disturbances = Disturb(cluster, kServers, length, random);
  ExpectGoodEnd(drags, kStreams);
  visitors.Stop();
  editors.Stop();

  std::string text = fmt::format("seed {}, {} s, {} servers\n", seed, length.count(), kServers);
  text += Ledger(disturbances, start, drags.interruptions());
  text += fmt::format("{} streams, {} shapes, {} resumptions, {} ended with the right last shape\n",
                      kStreams, drags.shapes(), drags.resumed(), drags.ended_well());
  text += fmt::format("{} calls, {} acknowledged sessions, {} lost\n", visitors.calls(),
                      visitors.acknowledged(), visitors.lost());
  text += JudgeAll(editors.Histories(), start);
  text +=
      fmt::format("errors that users saw: {}\n",
                  drags.complaint_count() + visitors.complaint_count() + editors.complaint_count());
  std::cout << text;
  if (const char* const file = std::getenv("ARAP_CHAOS_LEDGER")) {
    std::ofstream(file) << text;
    for (const char* const member : {"1", "2", "3", "redis", "haproxy"}) {
      std::ofstream(std::string(file) + "." + member + ".log") << cluster.Log(member);
    }
  }

  ExpectNoComplaint("a visitor", visitors);
  ExpectNoComplaint("an editor", editors);
  EXPECT_GT(visitors.acknowledged(), 0u);
  EXPECT_EQ(visitors.lost(), 0u);
}

TEST(Rolling, ARestartOfAllServersIsNotSeen) {
  constexpr std::size_t kServers = 3, kStreams = 200;
  const Puppet puppet = MakePuppet();
  Cluster cluster(kServers);
  ASSERT_TRUE(cluster.Start());
  Drags drags(cluster.address(), puppet, kStreams, milliseconds(500));
  ASSERT_TRUE(drags.AllMoved(2 * kPatience));
  for (std::size_t server = 1; server <= kServers; ++server) {
    const std::string member = std::to_string(server);
    EXPECT_EQ(cluster.Do("drain", member), member + " ended with 0");
    cluster.Do("start", member);
  }
  ExpectGoodEnd(drags, kStreams);
  EXPECT_GE(drags.resumed(), kStreams / 2) << "hardly a stream has moved";
}

TEST(Scaling, FromTwoToFourAndBackIsNotSeen) {
  constexpr std::size_t kStreams = 60;
  const Puppet puppet = MakePuppet();
  Cluster cluster(2);
  ASSERT_TRUE(cluster.Start());
  Drags before(cluster.address(), puppet, kStreams, milliseconds(100));
  ASSERT_TRUE(before.AllMoved(2 * kPatience));
  cluster.Do("add");
  cluster.Do("add");
  // Streams stay where they are; the sessions of new ones are on all four.
  Visitors visitors(cluster.address(), puppet, 4);
  for (const char* const server : {"3", "4"}) {
    EXPECT_TRUE(fault::Eventually(
        [&] { return cluster.Log(server).find("rpc=CreateSession") != std::string::npos; },
        2 * kPatience))
        << "nobody has come to " << server;
  }
  for (const char* const server : {"3", "4"}) {
    EXPECT_EQ(cluster.Do("drain", server), server + std::string(" ended with 0"));
  }
  visitors.Stop();
  ExpectNoComplaint("a visitor", visitors);
  EXPECT_EQ(visitors.lost(), 0u);
  ExpectGoodEnd(before, kStreams);
}

}  // namespace
}  // namespace arap::cluster
