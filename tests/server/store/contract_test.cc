// What every store promises, on each of them.
#include <atomic>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/token/digest.h"
#include "tests/server/store/records.h"
#include "tests/server/store/store_kind.h"
#include "tests/support/bounded.h"

namespace arap::store {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::Difference;
using testing::Next;
using testing::Now;
using testing::PlainRecord;

class ContractTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void Add(const std::string& owner, const std::string& id, char digit = 'a') {
    EXPECT_EQ(specs().Put(PlainRecord(owner, id, digit)), true);
  }
  SpecStore& specs() { return under_test_.specs(); }
  BlobStore& blobs() { return under_test_.blobs(); }

 private:
  testing::StoreUnderTest under_test_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Stores, ContractTest,
                         ::testing::Values(testing::StoreKind::kMemory, testing::StoreKind::kSqlite,
                                           testing::StoreKind::kRedis,
                                           testing::StoreKind::kRedisTls),
                         ::testing::PrintToStringParamName());

TEST_P(ContractTest, RandomRecordsComeBackBitForBit) {
  testing::Random random(21);
  for (int round = 0; round < 50; ++round) {
    SessionRecord record = testing::RandomRecord(random);
    record.key.id += std::to_string(round);
    record.revision = 1;
    ASSERT_EQ(specs().Put(record), true);
    const auto back = specs().Load(record.key);
    ASSERT_TRUE(back && *back);
    EXPECT_EQ(Difference(record, **back), "");
  }
}

TEST_P(ContractTest, WhatIsNotThereIsNothing) {
  EXPECT_EQ(specs().Load({"ann", "s"})->has_value(), false);
  EXPECT_EQ(specs().Version({"ann", "s"})->has_value(), false);
  EXPECT_EQ(specs().Remove({"ann", "s"}), false);
  EXPECT_EQ(specs().Extend({"ann", "s"}, "", Now()), false);
  EXPECT_EQ(specs().RemoveAsOf({"ann", "s"}, Now()), false);
  EXPECT_EQ(specs().Count(), 0u);
  EXPECT_TRUE(specs().Owners()->empty());
  EXPECT_TRUE(specs().Probe());
}

TEST_P(ContractTest, PutsOnlyInThePlaceOfTheRevisionBefore) {
  const SessionRecord first = PlainRecord("ann", "s");
  EXPECT_EQ(specs().Put(Next(first)), false) << "there is no revision 1";
  EXPECT_EQ(specs().Put(first), true);
  EXPECT_EQ(specs().Put(first), false);
  EXPECT_EQ(specs().Put(Next(Next(first))), false);
  EXPECT_EQ(specs().Put(Next(first)), true);
  EXPECT_EQ(**specs().Version(first.key), VersionOf(Next(first)));
}

// A session that was deleted and made again under its id is another one, whatever its revision.
TEST_P(ContractTest, AnotherIncarnationIsAnotherSession) {
  SessionRecord old = PlainRecord("ann", "s"), fresh = old;
  old.incarnation = "0123456789abcdef";
  fresh.incarnation = "fedcba9876543210";
  EXPECT_EQ(specs().Put(old), true);
  EXPECT_EQ(specs().Put(Next(old)), true);
  EXPECT_EQ(specs().Remove(old.key), true);
  EXPECT_EQ(specs().Put(fresh), true);
  EXPECT_EQ(specs().Put(Next(fresh)), true);
  EXPECT_NE(**specs().Version(old.key), VersionOf(Next(old)));
  EXPECT_EQ(specs().Put(Next(Next(old))), false);
  EXPECT_EQ(specs().Extend(old.key, old.incarnation, Now() + hours(9)), false);
  EXPECT_EQ(Difference(**specs().Load(old.key), Next(fresh)), "");
  EXPECT_EQ(specs().Put(Next(Next(fresh))), true);
}

TEST_P(ContractTest, RemovesAsOfAnExpiryOnlyWhatNobodyHasExtended) {
  const SessionRecord record = PlainRecord("ann", "s");
  EXPECT_EQ(specs().Put(record), true);
  const auto later = record.expires + hours(1);
  EXPECT_EQ(specs().Extend(record.key, record.incarnation, later), true);
  EXPECT_EQ(specs().RemoveAsOf(record.key, record.expires), false);
  EXPECT_TRUE(specs().Load(record.key)->has_value());
  EXPECT_EQ(specs().RemoveAsOf(record.key, later), true);
  EXPECT_EQ(specs().RemoveAsOf(record.key, later), false);
  EXPECT_EQ(specs().Count(), 0u);
}

TEST_P(ContractTest, ShiftMovesAllExpiriesOfAStoreWithoutAClock) {
  const SessionRecord record = PlainRecord("ann", "s");
  EXPECT_EQ(specs().Put(record), true);
  const auto time = specs().Time();
  ASSERT_TRUE(time);
  EXPECT_TRUE(specs().Shift(hours(-2)));
  const auto expires = (*specs().Load(record.key))->expires;
  EXPECT_EQ(expires, *time ? record.expires : record.expires - hours(2));
  if (*time) {
    EXPECT_LT(std::chrono::abs(**time - Now()), hours(1));
  }
}

TEST_P(ContractTest, KnowsItsIdAndHasNoWeakness) {
  const auto facts = specs().Facts();
  ASSERT_TRUE(facts) << facts.error().message;
  EXPECT_FALSE(facts->id.empty());
  EXPECT_TRUE(facts->weaknesses.empty()) << facts->weaknesses.front().sentence;
  EXPECT_EQ(specs().Facts()->id, facts->id);
  EXPECT_TRUE(blobs().Claim(facts->id));
  EXPECT_TRUE(blobs().Claim(facts->id));
}

TEST_P(ContractTest, OwnersDoNotSeeEachOther) {
  // Names that would meet if they were only joined.
  Add("ann", "x:y");
  Add("ann:x", "y");
  Add("", "ann:x:y");
  EXPECT_EQ(specs().Remove({"ann", "x:y"}), true);
  EXPECT_TRUE(specs().Load({"ann:x", "y"})->has_value());
  EXPECT_TRUE(specs().Load({"", "ann:x:y"})->has_value());
  EXPECT_EQ(*specs().Owners(), (std::vector<std::string>{"", "ann:x"}));
  EXPECT_TRUE(specs().List("ann", "", 10)->empty());
}

TEST_P(ContractTest, CountsFollowEveryChange) {
  Add("ann", "a");
  Add("ann", "b");
  Add("bob", "a");
  SessionRecord more = Next(PlainRecord("ann", "a"));
  more.meshes["hand"] = {std::string(64, 'b'), 5'000'000};
  more.handle_sets.clear();
  EXPECT_EQ(specs().Put(more), true);
  Usage usage = *specs().UsageOf("ann");
  EXPECT_EQ(usage.sessions, 2u);
  EXPECT_EQ(usage.meshes, 3u);
  EXPECT_EQ(usage.handle_sets, 1u);
  EXPECT_GE(usage.bytes, 5'000'000u);
  EXPECT_LT(usage.bytes, 5'010'000u);
  EXPECT_EQ(specs().Count(), 3u);
  more = Next(more);
  more.jobs["flat"] = {std::string(64, 'c'), 2'000'000, std::string(64, 'd'), 1'000'000, {}};
  EXPECT_EQ(specs().Put(more), true);
  usage = *specs().UsageOf("ann");
  EXPECT_GE(usage.bytes, 8'000'000u) << "of jobs too";
  EXPECT_LT(usage.bytes, 8'010'000u);
  EXPECT_EQ(specs().Remove({"ann", "b"}), true);
  usage = *specs().UsageOf("ann");
  EXPECT_EQ(usage.sessions, 1u);
  EXPECT_EQ(usage.meshes, 2u);
  EXPECT_EQ(usage.handle_sets, 0u);
  EXPECT_EQ(specs().Remove({"ann", "a"}), true);
  EXPECT_EQ(specs().UsageOf("ann")->sessions, 0u);
  EXPECT_EQ(specs().UsageOf("ann")->bytes, 0u);
  EXPECT_EQ(*specs().Owners(), (std::vector<std::string>{"bob"}));
  EXPECT_EQ(specs().Count(), 1u);
}

TEST_P(ContractTest, CountsAGatewayWithItsUsers) {
  EXPECT_EQ(specs().UsageUnder("hub")->sessions, 0u);
  Add("hub", "a");
  Add("hub", "b");
  Add("hub/ann", "a");
  Add("hub/zoe", "a");
  // Names that only begin alike, on both sides of the slash.
  Add("hub-1", "a");
  Add("hub0", "a");
  EXPECT_EQ(specs().UsageOf("hub")->sessions, 2u);
  EXPECT_EQ(specs().UsageOf("hub/ann")->sessions, 1u);
  const Usage all = *specs().UsageUnder("hub");
  EXPECT_EQ(all.sessions, 4u);
  EXPECT_EQ(all.meshes, 4 * specs().UsageOf("hub/ann")->meshes);
  EXPECT_EQ(all.handle_sets, 4 * specs().UsageOf("hub/ann")->handle_sets);
  EXPECT_EQ(specs().Remove({"hub/ann", "a"}), true);
  EXPECT_EQ(specs().UsageUnder("hub")->sessions, 3u);
}

TEST_P(ContractTest, ListsByIdInPages) {
  for (const char* id : {"c", "a", "e", "b", "d"}) Add("ann", id);
  Add("bob", "bb");
  std::string ids;
  std::string after;
  for (int page = 0; page < 3; ++page) {
    const auto records = specs().List("ann", after, 2);
    ASSERT_TRUE(records);
    EXPECT_EQ(records->size(), page < 2 ? 2u : 1u);
    for (const SessionRecord& record : *records) ids += record.key.id;
    after = records->back().key.id;
  }
  EXPECT_EQ(ids, "abcde");
  EXPECT_TRUE(specs().List("ann", "e", 2)->empty());
}

TEST_P(ContractTest, ExtendMovesTheExpiryAlone) {
  SessionRecord record = PlainRecord("ann", "s");
  record.expires -= hours(10);  // in the past, also by the clock of the store
  EXPECT_EQ(specs().Put(record), true);
  record.expires += hours(5);
  EXPECT_EQ(specs().Extend(record.key, record.incarnation, record.expires), true);
  EXPECT_EQ(Difference(**specs().Load(record.key), record), "");
  EXPECT_EQ(Difference(specs().List("ann", "", 1)->front(), record), "");
  EXPECT_TRUE(specs().RemoveExpired(record.expires - seconds(1), 10)->empty());
  EXPECT_EQ(specs().RemoveExpired(record.expires, 10)->size(), 1u);
}

TEST_P(ContractTest, RemovesWhatExpiredUpToALimit) {
  SessionRecord old = PlainRecord("ann", "old");
  for (int i = 0; i < 5; ++i) {
    old.key.id = "old" + std::to_string(i);
    old.expires = Now() - hours(48);
    EXPECT_EQ(specs().Put(old), true);
  }
  Add("ann", "new");
  EXPECT_TRUE(specs().Load(old.key)->has_value()) << "expired or not";
  EXPECT_EQ(specs().RemoveExpired(Now(), 2)->size(), 2u);
  EXPECT_EQ(specs().RemoveExpired(Now(), 10)->size(), 3u);
  EXPECT_TRUE(specs().RemoveExpired(Now(), 10)->empty());
  EXPECT_EQ(specs().UsageOf("ann")->sessions, 1u);
  EXPECT_EQ(specs().Count(), 1u);
  EXPECT_FALSE(specs().Load(old.key)->has_value());
}

TEST_P(ContractTest, NamesTheBlobsOfTheRecordsThatAreThere) {
  Add("ann", "s", 'a');
  Add("bob", "s", 'b');
  Add("bob", "t", 'a');
  EXPECT_EQ(specs().ReferencedBlobs()->size(), 2u);
  SessionRecord change = Next(PlainRecord("bob", "s", 'c'));
  EXPECT_EQ(specs().Put(change), true);
  EXPECT_EQ(*specs().ReferencedBlobs(),
            (std::set<std::string>{std::string(64, 'a'), std::string(64, 'c')}));
  EXPECT_EQ(specs().Remove({"bob", "s"}), true);
  EXPECT_EQ(*specs().ReferencedBlobs(), (std::set<std::string>{std::string(64, 'a')}));
}

TEST_P(ContractTest, OneOfManyWritersWinsEveryRevision) {
  constexpr std::uint64_t kRevisions = 40;
  std::atomic<std::uint64_t> wins{0};
  constexpr std::size_t kWriters = 4;
  std::vector<testing::BoundedThread> writers;
  writers.reserve(kWriters);
  for (std::size_t writer = 0; writer < kWriters; ++writer) {
    writers.emplace_back("a writer", [this, &wins] {
      for (std::uint64_t revision = 1; revision <= kRevisions; ++revision) {
        SessionRecord record = PlainRecord("ann", "s");
        record.revision = revision;
        auto put = specs().Put(record);
        if (put && *put) ++wins;
        EXPECT_TRUE(put);
      }
    });
  }
  writers.clear();
  EXPECT_EQ(wins, kRevisions);
  EXPECT_EQ((*specs().Version({"ann", "s"}))->revision, kRevisions);
  EXPECT_EQ(specs().UsageOf("ann")->meshes, 1u);
}

TEST_P(ContractTest, ReferencesAreRightWhileOthersWrite) {
  Add("ann", "stays", 'f');
  std::atomic<bool> done{false};
  testing::BoundedThread writer("the writer", [&] {
    for (int i = 0; i < 100; ++i) {
      const std::string id = "s" + std::to_string(i);
      EXPECT_EQ(specs().Put(PlainRecord("ann", id, 'b')), true);
      EXPECT_EQ(specs().Remove({"ann", id}), true);
    }
    done = true;
  });
  while (!done) EXPECT_TRUE(specs().ReferencedBlobs()->contains(std::string(64, 'f')));
  writer.Join();
  EXPECT_EQ(specs().ReferencedBlobs()->size(), 1u);
}

TEST_P(ContractTest, BlobsComeBackAndAreSweptWhenNobodyNamesThem) {
  const std::string kept = *Sha256Hex("kept"), gone = *Sha256Hex("gone");
  EXPECT_TRUE(blobs().Put(kept, "kept"));
  EXPECT_TRUE(blobs().Put(gone, "gone"));
  EXPECT_TRUE(blobs().Put(gone, "gone"));
  EXPECT_EQ(blobs().Get(gone), "gone");
  EXPECT_EQ(blobs().Sweep({kept}, {hours(1), seconds(0)})->removed, 0u) << "too young";
  const auto report = blobs().Sweep({kept}, {seconds(0), seconds(0)});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->removed, 1u);
  EXPECT_EQ(report->removed_bytes, 4u);
  EXPECT_EQ(report->kept, 1u);
  EXPECT_EQ(report->kept_bytes, 4u);
  EXPECT_EQ(blobs().Get(kept), "kept");
  const auto missing = blobs().Get(gone);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, FaultKind::kDataLoss);
}

}  // namespace
}  // namespace arap::store
