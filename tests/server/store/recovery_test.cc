// Databases that are damaged: what can be read goes on, the rest is named.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "server/store/open_store.h"
#include "server/store/sqlite/sqlite.h"
#include "tests/server/store/records.h"
#include "tests/server/store/temp_dir.h"

namespace arap::store {
namespace {

constexpr std::size_t kPage = 4096;

class RecoveryTest : public ::testing::Test {
 protected:
  static constexpr int kRecords = 60;

  Result<Stores> Open() {
    StoreOptions options;
    options.store = "sqlite:" + (dir_ / "state");
    options.on_recovery = [this](const Recovery& recovery) { heard_ = recovery; };
    return OpenStores(options);
  }
  static std::string Id(int i) { return "s" + std::to_string(i); }
  // About a page each.
  static SessionRecord Record(int i, std::size_t size) {
    SessionRecord record = testing::PlainRecord("ann", Id(i));
    record.created = record.expires = runtime::Clock::Wall(std::chrono::hours(24 * 365 * 80));
    record.labels["size"] = std::string(size, static_cast<char>('a' + i % 26));
    return record;
  }
  void Fill(std::size_t size = 1500) {
    auto stores = Open();
    ASSERT_TRUE(stores);
    for (int i = 0; i < kRecords; ++i) ASSERT_EQ(stores->specs->Put(Record(i, size)), true);
  }
  // Each record is what it was, or a named loss; the number of losses.
  static std::size_t CountLost(SpecStore& specs, std::size_t size = 1500) {
    std::size_t lost = 0;
    for (int i = 0; i < kRecords; ++i) {
      const auto record = specs.Load({"ann", Id(i)});
      if (record && *record) {
        EXPECT_EQ(testing::Difference(**record, Record(i, size)), "");
        continue;
      }
      ++lost;
      if (record) continue;  // left no trace
      EXPECT_EQ(record.error().kind, FaultKind::kDataLoss) << record.error().message;
    }
    return lost;
  }
  std::size_t Pages() const { return std::filesystem::file_size(Database()) / kPage; }
  std::string Database() const { return dir_ / "state/sessions.db"; }

  testing::TempDir dir_;
  std::optional<Recovery> heard_;
};

TEST_F(RecoveryTest, AnyPageMayBeDamagedBeforeOpening) {
  Fill();
  const std::string good = testing::Slurp(Database());
  std::size_t most_saved = 0;
  for (std::size_t page = 0; page < Pages(); ++page) {
    testing::Spill(Database(), good);
    testing::Smash(Database(), page * kPage, std::string(kPage, '\xa5'));
    auto stores = Open();
    ASSERT_TRUE(stores) << stores.error().message;
    const std::size_t lost = CountLost(*stores->specs);
    if (stores->recovery) {
      EXPECT_TRUE(std::filesystem::exists(stores->recovery->kept_as));
      EXPECT_EQ(stores->recovery->saved, kRecords - lost) << page;
      EXPECT_LE(stores->recovery->lost, lost) << page;
      EXPECT_TRUE(!stores->recovery->complete || stores->recovery->lost == lost) << page;
      most_saved = std::max(most_saved, stores->recovery->saved);
      // One page holds no more than a few rows; only the first holds the way to all of them.
      EXPECT_TRUE(page < 9 || lost <= 4) << page << " " << lost;
    }
    EXPECT_EQ(stores->specs->Put(testing::PlainRecord("bob", "new")), true);
    EXPECT_EQ(stores->specs->UsageOf("bob")->sessions, 1u);
  }
  EXPECT_EQ(most_saved, static_cast<std::size_t>(kRecords)) << "damage of an index loses nothing";
}

TEST_F(RecoveryTest, APageMayBeDamagedWhileOpen) {
  constexpr std::size_t kLarge = 60'000;  // more in all than SQLite keeps in memory
  Fill(kLarge);
  auto stores = Open();
  ASSERT_TRUE(stores);
  ASSERT_FALSE(stores->recovery);
  for (std::size_t page = 20; page < Pages(); page += 40) {
    testing::Smash(Database(), page * kPage, std::string(kPage, '\xa5'));
  }
  CountLost(*stores->specs, kLarge);  // some answers still come from memory
  ASSERT_TRUE(heard_) << "the damage was noticed";
  const std::size_t lost = CountLost(*stores->specs, kLarge);
  EXPECT_GT(lost, 0u);
  EXPECT_LT(lost, static_cast<std::size_t>(kRecords));
  EXPECT_EQ(heard_->lost, lost);
  EXPECT_EQ(heard_->saved, kRecords - lost);
  EXPECT_EQ(stores->specs->Put(testing::PlainRecord("bob", "new")), true);
  EXPECT_EQ(CountLost(*stores->specs, kLarge), lost) << "named losses stay named";
}

TEST_F(RecoveryTest, ARecordWithAFlippedBitIsLostAlone) {
  Fill();
  std::string bytes = testing::Slurp(Database());
  const std::size_t at = bytes.find(std::string(1000, 'c'));  // the label of s2 or s28 or s54
  ASSERT_NE(at, std::string::npos);
  testing::Smash(Database(), at + 500, "C");
  auto stores = Open();
  ASSERT_TRUE(stores);
  EXPECT_FALSE(stores->recovery) << "the database is sound";
  EXPECT_EQ(CountLost(*stores->specs), 1u);
  EXPECT_EQ(stores->specs->List("ann", "", 100)->size(), kRecords - 1u);
  EXPECT_EQ(stores->specs->Count(), static_cast<std::size_t>(kRecords));
}

TEST_F(RecoveryTest, RemainsAreRemovedWhenTheyExpire) {
  Fill();
  testing::Smash(Database(), (Pages() - 3) * kPage, std::string(kPage, '\xa5'));
  auto stores = Open();
  ASSERT_TRUE(stores && stores->recovery);
  ASSERT_GT(stores->recovery->lost, 0u);
  EXPECT_EQ(stores->specs->Count(), static_cast<std::size_t>(kRecords));
  const auto end = runtime::Clock::Wall(std::chrono::hours(24 * 365 * 81));
  EXPECT_EQ(stores->specs->RemoveExpired(end, 1000)->size(), static_cast<std::size_t>(kRecords));
  EXPECT_EQ(CountLost(*stores->specs), static_cast<std::size_t>(kRecords));
}

TEST_F(RecoveryTest, WhatIsNoDatabaseIsMovedAside) {
  for (const char fill : {'x', '\0'}) {
    const std::string bytes(3 * kPage, fill);
    { ASSERT_TRUE(Open()); }
    testing::Spill(Database(), bytes);
    auto stores = Open();
    ASSERT_TRUE(stores) << stores.error().message;
    ASSERT_TRUE(stores->recovery);
    EXPECT_FALSE(stores->recovery->complete);
    EXPECT_EQ(testing::Slurp(stores->recovery->kept_as), bytes);
    EXPECT_EQ(stores->specs->Count(), 0u);
  }
  EXPECT_TRUE(std::filesystem::exists(dir_ / "state/sessions.db.corrupt-2"));
}

TEST_F(RecoveryTest, ALaterVersionIsLeftAlone) {
  { ASSERT_TRUE(Open()); }
  {
    auto database = Sqlite::Open(Database(), Sqlite::Missing::kRefuse);
    ASSERT_TRUE(database);
    ASSERT_EQ(database->Run("PRAGMA user_version = 3"), SQLITE_OK);
  }
  const std::string before = testing::Slurp(Database());
  const auto stores = Open();
  ASSERT_FALSE(stores);
  EXPECT_NE(stores.error().message.find("later version"), std::string::npos);
  EXPECT_EQ(testing::Slurp(Database()), before);
}

// Every moment at which a recovery may be interrupted.
TEST_F(RecoveryTest, AnInterruptedRecoveryIsFinished) {
  Fill();
  const std::string good = testing::Slurp(Database());
  const std::string state = dir_ / "state/";
  // Half a new one.
  testing::Spill(state + "sessions.db.new", good.substr(0, 5000));
  EXPECT_EQ(CountLost(*Open()->specs), 0u);
  // The new one is ready; the damaged one is there, with a log, or only its log, or neither.
  for (int step = 0; step < 3; ++step) {
    std::filesystem::remove(Database());
    if (step == 0) testing::Spill(Database(), "damaged");
    if (step <= 1) testing::Spill(Database() + "-wal", "the log of the damaged one");
    testing::Spill(state + "sessions.db.ready", good);
    auto stores = Open();
    ASSERT_TRUE(stores) << stores.error().message;
    EXPECT_EQ(CountLost(*stores->specs), 0u) << step;
  }
}

}  // namespace
}  // namespace arap::store
