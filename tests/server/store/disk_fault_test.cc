// Disks that are full or read-only: a named fault while it lasts, and no restart after it.
#include <string>

#include <gtest/gtest.h>

#include "core/token/digest.h"
#include "server/store/open_store.h"
#include "tests/server/store/disk.h"
#include "tests/server/store/records.h"

namespace arap::store {
namespace {

using testing::Difference;
using testing::Next;
using testing::PlainRecord;

Stores OpenAt(const std::string& directory) {
  StoreOptions options;
  options.store = "sqlite:" + directory;
  auto stores = OpenStores(options);
  EXPECT_TRUE(stores) << stores.error().message;
  return *std::move(stores);
}

SessionRecord Large(const std::string& id) {
  SessionRecord record = PlainRecord("ann", id);
  record.labels["large"] = std::string(40'000, 'x');
  return record;
}

// Puts until the disk refuses, which has to be before `most`; the number that were acknowledged.
int PutUntilFull(SpecStore& specs, int most) {
  for (int i = 0; i < most; ++i) {
    const auto put = specs.Put(Large("s" + std::to_string(i)));
    if (put) continue;
    EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable) << put.error().message;
    return i;
  }
  ADD_FAILURE() << "never full";
  return most;
}

void ExpectAll(SpecStore& specs, int count) {
  EXPECT_EQ(specs.Count(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto record = specs.Load({"ann", "s" + std::to_string(i)});
    ASSERT_TRUE(record && *record) << i;
    EXPECT_EQ((*record)->labels.at("large").size(), 40'000u);
  }
}

void ExpectNoBlob(BlobStore& blobs, const std::string& bytes) {
  const auto put = blobs.Put(*Sha256Hex(bytes), bytes);
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable) << put.error().message;
}

TEST(DiskFaultTest, FullDisk) {
  testing::TinyDisk disk;
  if (!disk.mounted()) GTEST_SKIP() << "no rights to mount; FileSizeLimit covers what it can";
  Stores stores = OpenAt(disk.path() + "/state");
  const std::string blob(100'000, 'b');
  const std::string hash = *Sha256Hex(blob);
  ASSERT_TRUE(stores.blobs->Put(hash, blob));
  disk.Fill();
  const int count = PutUntilFull(*stores.specs, 100);
  ExpectAll(*stores.specs, count);
  ExpectNoBlob(*stores.blobs, std::string(200'000, 'c'));
  EXPECT_EQ(stores.blobs->Get(hash), blob);
  disk.Free();
  EXPECT_EQ(stores.specs->Put(Large("s" + std::to_string(count))), true);
  ExpectAll(*stores.specs, count + 1);
  EXPECT_TRUE(stores.blobs->Put(*Sha256Hex("c"), "c"));
}

TEST(DiskFaultTest, FilesThatMayNotGrow) {
  const testing::TempDir dir;
  Stores stores = OpenAt(dir / "state");
  int count = 0;
  {
    const testing::FileSizeLimit limit(300'000);
    count = PutUntilFull(*stores.specs, 100);
    ExpectAll(*stores.specs, count);
    ExpectNoBlob(*stores.blobs, std::string(400'000, 'c'));
  }
  EXPECT_GT(count, 0);
  EXPECT_EQ(stores.specs->Put(Large("s" + std::to_string(count))), true);
  ExpectAll(*stores.specs, count + 1);
  const std::string blob(400'000, 'c');
  EXPECT_TRUE(stores.blobs->Put(*Sha256Hex(blob), blob));
}

TEST(DiskFaultTest, ReadOnlyDisk) {
  testing::TinyDisk disk;
  if (!disk.mounted()) GTEST_SKIP() << "no rights to mount; FilesThatMayNotGrow covers what it can";
  const std::string state = disk.path() + "/state";
  { OpenAt(state); }
  ASSERT_TRUE(disk.SetReadOnly(true));
  StoreOptions options;
  options.store = "sqlite:" + state;
  const auto stores = OpenStores(options);
  ASSERT_FALSE(stores);
  EXPECT_EQ(stores.error().kind, FaultKind::kStoreUnavailable);
  EXPECT_NE(stores.error().message.find(state), std::string::npos) << stores.error().message;
  ASSERT_TRUE(disk.SetReadOnly(false));
  EXPECT_EQ(OpenAt(state).specs->Put(PlainRecord("ann", "s")), true);
}

// What a file system does that goes read-only under our feet.
TEST(DiskFaultTest, FilesThatBecomeUnchangeable) {
  const testing::TempDir dir;
  Stores stores = OpenAt(dir / "state");
  const SessionRecord record = PlainRecord("ann", "s");
  ASSERT_EQ(stores.specs->Put(record), true);
  ASSERT_TRUE(stores.blobs->Put(*Sha256Hex("b"), "b"));
  const std::string log = dir / "state/sessions.db-wal", tmp = dir / "state/blobs/tmp";
  if (!testing::SetImmutable(log, true)) {
    GTEST_SKIP() << "no rights to make files immutable; FilesThatMayNotGrow covers what it can";
  }
  ASSERT_TRUE(testing::SetImmutable(tmp, true));
  for (int i = 0; i < 3; ++i) {
    const auto put = stores.specs->Put(Next(record));
    EXPECT_TRUE(!put && put.error().kind == FaultKind::kStoreUnavailable);
  }
  ExpectNoBlob(*stores.blobs, "c");
  EXPECT_EQ(stores.blobs->Get(*Sha256Hex("b")), "b");
  EXPECT_TRUE(testing::SetImmutable(log, false));
  EXPECT_TRUE(testing::SetImmutable(tmp, false));
  EXPECT_EQ(stores.specs->Put(Next(record)), true);
  EXPECT_TRUE(stores.blobs->Put(*Sha256Hex("c"), "c"));
  EXPECT_EQ(Difference(**stores.specs->Load(record.key), Next(record)), "");
}

TEST(DiskFaultTest, ADatabaseThatIsTakenAwayTakesNothingMore) {
  const testing::TempDir dir;
  Stores stores = OpenAt(dir / "state");
  const SessionRecord record = PlainRecord("ann", "s");
  ASSERT_EQ(stores.specs->Put(record), true);
  std::filesystem::rename(dir / "state", dir / "elsewhere");
  const auto put = stores.specs->Put(Next(record));
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable);
  EXPECT_FALSE(stores.specs->Probe());
  EXPECT_EQ(stores.blobs->Get(std::string(64, 'a')).error().kind, FaultKind::kStoreUnavailable);
  std::filesystem::rename(dir / "elsewhere", dir / "state");
  EXPECT_EQ(stores.specs->Put(Next(record)), true);
}

}  // namespace
}  // namespace arap::store
