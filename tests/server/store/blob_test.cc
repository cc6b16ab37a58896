// Blob files: durable names, damage that is noticed, a sweep that touches only its own.
#include <atomic>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/token/digest.h"
#include "server/store/blobs/file_blobs.h"
#include "tests/server/store/temp_dir.h"
#include "tests/support/bounded.h"

namespace arap::store {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::seconds;

// Set aside and removed in one go.
constexpr SweepRules kAtOnce{hours(1), seconds(0)};

class BlobTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = FileBlobStore::Open(root_);
    ASSERT_TRUE(opened);
    blobs_ = *std::move(opened);
    ASSERT_TRUE(blobs_->Put(hash_, bytes_));
  }
  std::string PathOf(const std::string& hash) const {
    return root_ + "/" + hash.substr(0, 2) + "/" + hash.substr(2, 2) + "/" + hash;
  }
  std::string WhyLost() {
    const auto got = blobs_->Get(hash_);
    if (got) return "not lost";
    EXPECT_EQ(got.error().kind, FaultKind::kDataLoss);
    EXPECT_EQ(got.error().details.at(0), std::make_pair(std::string("blob"), hash_));
    return got.error().details.at(1).second;
  }
  void MakeOld(const std::string& path) {
    fs::last_write_time(path, fs::file_time_type::clock::now() - hours(3));
  }

  testing::TempDir dir_;
  const std::string root_ = dir_ / "blobs";
  const std::string bytes_ = std::string(100'000, 'm');
  const std::string hash_ = *Sha256Hex(bytes_);
  std::unique_ptr<FileBlobStore> blobs_;
};

TEST_F(BlobTest, DamageIsNamedAndPutRepairsIt) {
  EXPECT_EQ(WhyLost(), "not lost");
  fs::resize_file(PathOf(hash_), 99'000);
  EXPECT_EQ(WhyLost(), "damaged");
  EXPECT_TRUE(blobs_->Put(hash_, bytes_));
  testing::Smash(PathOf(hash_), 50'000, "M");
  EXPECT_EQ(WhyLost(), "damaged");
  EXPECT_TRUE(blobs_->Put(hash_, bytes_));
  fs::remove(PathOf(hash_));
  EXPECT_EQ(WhyLost(), "missing");
  EXPECT_TRUE(blobs_->Put(hash_, bytes_));
  EXPECT_EQ(blobs_->Get(hash_), bytes_);
}

TEST_F(BlobTest, AnEmptyBlobIsABlob) {
  const std::string hash = *Sha256Hex("");
  EXPECT_TRUE(blobs_->Put(hash, ""));
  EXPECT_EQ(blobs_->Get(hash), "");
}

TEST_F(BlobTest, NamesThatAreNoDigestReachNoFile) {
  for (const std::string& name : {std::string("../../x"), std::string(), std::string(64, 'A'),
                                  std::string(63, 'a'), "../" + std::string(61, 'a')}) {
    EXPECT_EQ(blobs_->Put(name, "x").error().kind, FaultKind::kInternal);
    EXPECT_EQ(blobs_->Get(name).error().kind, FaultKind::kDataLoss);
  }
}

TEST_F(BlobTest, LinksAreNotFollowed) {
  testing::Spill(dir_ / "other", bytes_);
  fs::remove(PathOf(hash_));
  fs::create_symlink(dir_ / "other", PathOf(hash_));
  EXPECT_EQ(WhyLost(), "damaged");
  EXPECT_TRUE(blobs_->Put(hash_, bytes_));
  EXPECT_EQ(WhyLost(), "not lost");
}

TEST_F(BlobTest, PuttingAgainMakesYoung) {
  MakeOld(PathOf(hash_));
  EXPECT_TRUE(blobs_->Put(hash_, bytes_));
  EXPECT_EQ(blobs_->Sweep({}, kAtOnce)->removed, 0u);
  MakeOld(PathOf(hash_));
  EXPECT_EQ(blobs_->Sweep({hash_}, kAtOnce)->removed, 0u);
  EXPECT_EQ(blobs_->Sweep({}, kAtOnce)->removed, 1u);
  EXPECT_EQ(WhyLost(), "missing");
}

TEST_F(BlobTest, TheSweepRemovesWhatWritersLeftAndNothingElse) {
  const std::string left = root_ + "/tmp/" + hash_ + ".abcdef";
  const std::string young = root_ + "/tmp/" + hash_ + ".ghijkl";
  const std::vector<std::string> foreign{root_ + "/README", root_ + "/tmp/notes",
                                         fs::path(PathOf(hash_)).parent_path() / "notes"};
  testing::Spill(left, "half");
  testing::Spill(young, "half");
  for (const std::string& path : foreign) {
    testing::Spill(path, "mine");
    MakeOld(path);
  }
  MakeOld(left);
  const auto report = blobs_->Sweep({hash_}, kAtOnce);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->removed, 1u);
  EXPECT_EQ(report->kept, 1u);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(young));
  for (const std::string& path : foreign) EXPECT_TRUE(fs::exists(path)) << path;
}

TEST_F(BlobTest, WhatNobodyNamesLiesAsideFirstAndComesBackWhenAskedFor) {
  constexpr SweepRules kRules{hours(1), hours(24)};
  const std::string aside = root_ + "/aside/" + hash_;
  MakeOld(PathOf(hash_));
  auto report = blobs_->Sweep({}, kRules);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->aside, 1u);
  EXPECT_EQ(report->kept + report->removed, 0u);
  EXPECT_TRUE(fs::exists(aside));
  EXPECT_EQ(blobs_->Get(hash_), bytes_);
  EXPECT_FALSE(fs::exists(aside));
  EXPECT_EQ(blobs_->Sweep({}, kRules)->kept, 1u) << "as young as a new one";

  MakeOld(PathOf(hash_));
  EXPECT_EQ(blobs_->Sweep({}, kRules)->aside, 1u);
  EXPECT_TRUE(blobs_->Sweep({hash_}, kRules));
  EXPECT_TRUE(fs::exists(PathOf(hash_))) << "a record names it again";

  MakeOld(PathOf(hash_));
  EXPECT_EQ(blobs_->Sweep({}, kRules)->aside, 1u);
  fs::last_write_time(aside, fs::file_time_type::clock::now() - hours(23));
  EXPECT_EQ(blobs_->Sweep({}, kRules)->aside, 1u);
  fs::last_write_time(aside, fs::file_time_type::clock::now() - hours(25));
  EXPECT_EQ(blobs_->Sweep({}, kRules)->removed, 1u);
  EXPECT_EQ(WhyLost(), "missing");
}

TEST_F(BlobTest, TooManyAtOnceStayWhereTheyAre) {
  std::set<std::string> named;
  for (int i = 0; i < 20; ++i) {
    const std::string bytes = std::to_string(i);
    const std::string hash = *Sha256Hex(bytes);
    ASSERT_TRUE(blobs_->Put(hash, bytes));
    MakeOld(PathOf(hash));
    if (i < 8) named.insert(hash);
  }
  SweepRules rules{hours(1), hours(24), 0.5, 5};
  const auto held = blobs_->Sweep(named, rules);
  ASSERT_TRUE(held);
  EXPECT_EQ(held->held_back, 12u);
  EXPECT_EQ(held->kept, 21u);
  EXPECT_EQ(held->aside, 0u);
  rules.few = 12;
  EXPECT_EQ(blobs_->Sweep(named, rules)->aside, 12u) << "a few are never too many";
}

TEST_F(BlobTest, AFolderBelongsToOneStore) {
  EXPECT_TRUE(blobs_->Claim("one"));
  EXPECT_TRUE(blobs_->Claim("one"));
  const Status other = blobs_->Claim("another");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(other.error().field, "blob_dir");
  EXPECT_NE(other.error().message.find(root_ + "/store-id"), std::string::npos);
  fs::remove(root_ + "/store-id");
  EXPECT_TRUE(blobs_->Claim("another"));
}

// Whoever has put a blob finds it, whatever sweeps run: the age protects it.
TEST_F(BlobTest, WhatWasJustPutIsNotSwept) {
  auto other = FileBlobStore::Open(root_);  // another replica
  ASSERT_TRUE(other);
  std::atomic<bool> done{false};
  testing::BoundedThread sweeper("the sweeper", [&] {
    while (!done) EXPECT_TRUE((*other)->Sweep({}, kAtOnce));
  });
  for (int i = 0; i < 200; ++i) {
    std::error_code gone;  // swept while it was old
    fs::last_write_time(PathOf(hash_), fs::file_time_type::clock::now() - hours(3), gone);
    EXPECT_TRUE(blobs_->Put(hash_, bytes_));
    EXPECT_EQ(blobs_->Get(hash_), bytes_) << i;
  }
  done = true;
  sweeper.Join();
}

}  // namespace
}  // namespace arap::store
