// Blobs in an object store: what is put is there, what nobody names goes in two steps, secrets stay
// secret, and the cache is only ever a copy.
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/token/digest.h"
#include "server/store/blobs/s3_blobs.h"
#include "server/store/open_store.h"
#include "tests/server/store/records.h"
#include "tests/server/store/s3_server.h"
#include "tests/server/store/temp_dir.h"

namespace arap::store {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::seconds;

constexpr std::size_t kRoom = 1'000'000;

TEST(S3NamesTest, UrlsOfBuckets) {
  S3Options options;
  ASSERT_TRUE(ParseS3Url("s3://my-bucket.1", options));
  EXPECT_EQ(options.bucket, "my-bucket.1");
  EXPECT_EQ(options.prefix, "");
  ASSERT_TRUE(ParseS3Url("s3://arapd/a/b_c/", options));
  EXPECT_EQ(options.prefix, "a/b_c/");
  for (const char* bad :
       {"", "s3:", "s3://", "s3://ab", "s3:///x", "http://arapd", "s3://a b c", "s3://arapd/a b",
        "s3://arapd//a", "s3://arapd/a//b", "s3://arapd/a?b", "s3://arapd/\xc3\xa4"}) {
    const Status parsed = ParseS3Url(bad, options);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_EQ(parsed.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(parsed.error().field, "blob_store");
  }
}

TEST(S3NamesTest, CredentialsAreReadAsOtherProgramsDo) {
  const testing::TempDir dir;
  const std::string file = dir / "credentials";
  testing::Spill(file,
                 "# of the shop\n[other]\naws_access_key_id = X\n\n[default]\r\n"
                 "aws_access_key_id=ID\naws_secret_access_key =  s3cret/=+ \n[more]\n"
                 "aws_secret_access_key = Y\n");
  S3Options options;
  options.session_token = "of before";
  ASSERT_TRUE(ReadS3Credentials(file, options));
  EXPECT_EQ(options.key_id, "ID");
  EXPECT_EQ(options.secret, "s3cret/=+");
  EXPECT_EQ(options.session_token, "");
  for (const char* bad : {"", "aws_access_key_id = ID\n", "ID:s3cret\n",
                          "[more]\naws_access_key_id = ID\naws_secret_access_key = s3cret\n"}) {
    testing::Spill(file, bad);
    const Status read = ReadS3Credentials(file, options);
    ASSERT_FALSE(read) << bad;
    EXPECT_EQ(read.error().field, "s3_credentials_file");
    EXPECT_NE(read.error().message.find(file), std::string::npos);
    EXPECT_EQ(read.error().message.find("s3cret"), std::string::npos);
  }
  EXPECT_FALSE(ReadS3Credentials(dir / "none", options));
}

TEST(S3NamesTest, WhatIsToldHasToFit) {
  const testing::TempDir dir;
  StoreOptions good;
  good.store = "sqlite:" + (dir / "state");
  good.blob_store = "s3://arapd";
  good.s3.key_id = "ID";
  good.s3.secret = "s3cret";
  EXPECT_TRUE(CheckStore(good));
  const auto field = [&good](const auto& change) {
    StoreOptions options = good;
    change(options);
    const Status checked = CheckStore(options);
    if (checked) return std::string("good");
    EXPECT_EQ(checked.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(checked.error().message.find("s3cret"), std::string::npos);
    return checked.error().field;
  };
  EXPECT_EQ(field([](auto& o) { o.store = "redis://h"; }), "good") << "needs no --blob-dir";
  EXPECT_EQ(field([](auto& o) { o.store = "memory"; }), "blob_store");
  EXPECT_EQ(field([](auto& o) { o.blob_store = "s3:"; }), "blob_store");
  EXPECT_EQ(field([](auto& o) { o.s3.region = "a/b"; }), "s3_region");
  EXPECT_EQ(field([](auto& o) { o.s3.region = ""; }), "s3_region");
  for (const char* bad : {"host", "ftp://host", "https://", "https://a/b", "https://u:s3cret@a"}) {
    EXPECT_EQ(field([bad](auto& o) { o.s3.endpoint = bad; }), "s3_endpoint") << bad;
  }
  EXPECT_EQ(field([](auto& o) { o.s3.endpoint = "http://[::1]:9000/"; }), "good");
  EXPECT_EQ(field([](auto& o) { o.s3.key_id = ""; }), "s3_credentials_file");
  EXPECT_EQ(field([](auto& o) { o.s3.credentials_file = "none"; }), "s3_credentials_file");
  EXPECT_EQ(field([](auto& o) {
              o.blob_store = "";
              o.s3.endpoint = "http://a";
            }),
            "s3_endpoint");
}

class BlobCacheTest : public ::testing::Test {
 protected:
  static std::string Bytes(char c) { return std::string(1'000, c); }
  static std::string HashOf(char c) { return *Sha256Hex(Bytes(c)); }
  std::unique_ptr<BlobCache> Open(std::size_t most = kRoom) {
    auto cache = BlobCache::Open(folder_, most);
    EXPECT_TRUE(cache) << cache.error().message;
    return cache ? *std::move(cache) : nullptr;
  }

  testing::TempDir dir_;
  const std::string folder_ = dir_ / "cache";
};

TEST_F(BlobCacheTest, IsACopyOrNothing) {
  auto cache = Open();
  EXPECT_EQ(cache->Get(HashOf('a')), std::nullopt);
  cache->Put(HashOf('a'), Bytes('a'));
  cache->Put(HashOf('a'), Bytes('a'));
  EXPECT_EQ(cache->Get(HashOf('a')), Bytes('a'));
  EXPECT_EQ(cache->bytes(), 1'000u);
  testing::Smash(folder_ + "/" + HashOf('a'), 500, "x");
  EXPECT_EQ(cache->Get(HashOf('a')), std::nullopt) << "damaged";
  EXPECT_EQ(cache->bytes(), 0u);
  cache->Put("../up", "x");
  EXPECT_EQ(cache->Get("../up"), std::nullopt);
  cache->Put(HashOf('b'), Bytes('b'));
  testing::Spill(folder_ + "/" + HashOf('c') + ".abcdef", "half of it");
  const auto second = BlobCache::Open(folder_, kRoom);
  ASSERT_FALSE(second) << "one process for each";
  EXPECT_NE(second.error().message.find(folder_), std::string::npos);
  cache.reset();
  cache = Open();
  EXPECT_EQ(cache->Get(HashOf('b')), Bytes('b')) << "what an earlier server has left";
  EXPECT_FALSE(fs::exists(folder_ + "/" + HashOf('c') + ".abcdef"));
}

TEST_F(BlobCacheTest, WhatWasUsedLeastRecentlyGoes) {
  auto cache = Open(10'000);
  for (const char c : {'a', 'b', 'c', 'd', 'e', 'f', 'g', 'h', 'i', 'j'}) {
    cache->Put(HashOf(c), Bytes(c));
    // All equally long ago but for 'a', which is used again.
    fs::last_write_time(folder_ + "/" + HashOf(c), fs::file_time_type::clock::now() - hours(1));
  }
  EXPECT_TRUE(cache->Get(HashOf('a')));
  cache->Put(HashOf('k'), Bytes('k'));
  EXPECT_LE(cache->bytes(), 10'000u);
  EXPECT_GE(cache->bytes(), 8'000u);
  EXPECT_TRUE(cache->Get(HashOf('a')));
  EXPECT_TRUE(cache->Get(HashOf('k')));
  cache->Put(*Sha256Hex(std::string(6'000, 'z')), std::string(6'000, 'z'));
  EXPECT_TRUE(cache->Get(HashOf('a'))) << "one that is too large for it comes not in";
  cache.reset();
  EXPECT_LE(Open(3'000)->bytes(), 3'000u);
}

class S3Test : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::S3Server::Installed()) {
      GTEST_SKIP() << "NOT TESTED: s3rver is not there; script/setup --lint installs it";
    }
    server_ = std::make_unique<testing::S3Server>();
    blobs_ = std::make_unique<S3BlobStore>(server_->Options(), nullptr, seconds(0));
  }
  std::string Put(const std::string& bytes) {
    const std::string hash = *Sha256Hex(bytes);
    EXPECT_TRUE(blobs_->Put(hash, bytes));
    return hash;
  }
  static std::string WhyLost(BlobStore& blobs, const std::string& hash) {
    const auto got = blobs.Get(hash);
    if (got) return "not lost";
    EXPECT_EQ(got.error().kind, FaultKind::kDataLoss) << got.error().message;
    return got.error().details.empty() ? "" : got.error().details.at(1).second;
  }

  std::unique_ptr<testing::S3Server> server_;
  std::unique_ptr<S3BlobStore> blobs_;
};

TEST_F(S3Test, WhatIsPutIsThereForEverybody) {
  const std::string large(3'000'000, 'm');
  const std::string hash = Put(large), empty = Put("");
  S3BlobStore other(server_->Options(), nullptr);
  EXPECT_EQ(other.Get(hash), large);
  EXPECT_EQ(other.Get(empty), "");
  EXPECT_EQ(WhyLost(other, *Sha256Hex("never put")), "missing");
  EXPECT_EQ(WhyLost(other, "../../x"), "missing");
  EXPECT_EQ(blobs_->Put("../../x", "x").error().kind, FaultKind::kInternal);
  // Another's hand.
  ASSERT_TRUE(S3Client(server_->Options()).Put("blobs/" + hash, "junk", *Sha256Hex("junk")));
  EXPECT_EQ(WhyLost(other, hash), "damaged");
  Put(large);
  EXPECT_EQ(other.Get(hash), large);
}

TEST_F(S3Test, WhatNobodyNamesGoesInTwoSteps) {
  const std::string named = Put("named"), first = Put("first"), second = Put("second");
  const SweepRules young{hours(1), seconds(0)}, aside{seconds(0), hours(1)};
  EXPECT_EQ(blobs_->Sweep({}, young)->kept, 3u) << "one may belong to a record that is to come";
  auto report = blobs_->Sweep({named}, aside);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->kept, 1u);
  EXPECT_EQ(report->aside, 2u);
  EXPECT_EQ(report->removed, 0u);
  EXPECT_EQ(blobs_->Get(first), "first") << "brought back";
  report = blobs_->Sweep({named, first, second}, aside);
  EXPECT_EQ(report->kept + report->aside, 2u) << "counted before the third came back";
  EXPECT_EQ(S3Client(server_->Options()).List("blobs/")->objects.size(), 3u)
      << "what a record names comes back by itself";
  EXPECT_EQ(S3Client(server_->Options()).List("aside/")->objects.size(), 0u);
  ASSERT_TRUE(blobs_->Sweep({named}, aside));
  report = blobs_->Sweep({named}, {seconds(0), seconds(0)});
  EXPECT_EQ(report->removed, 2u);
  EXPECT_EQ(report->removed_bytes, 11u);
  EXPECT_EQ(WhyLost(*blobs_, first), "missing");
  EXPECT_EQ(blobs_->Get(named), "named");
}

TEST_F(S3Test, TooManyAtOnceStay) {
  for (int i = 0; i < 6; ++i) Put("blob " + std::to_string(i));
  const std::string named = Put("named");
  const SweepRules rules{seconds(0), hours(1), 0.5, 2};
  EXPECT_EQ(blobs_->Sweep({named}, rules)->held_back, 6u);
  EXPECT_EQ(blobs_->Sweep({named}, rules)->kept, 7u);
}

TEST_F(S3Test, ASweepThatComesTooSoonListsNothing) {
  S3BlobStore rare(server_->Options(), nullptr, hours(1));
  Put("one");
  const SweepRules rules{hours(1), hours(1)};
  EXPECT_EQ(rare.Sweep({}, rules)->kept, 1u);
  Put("two");
  EXPECT_EQ(rare.Sweep({}, rules)->kept, 1u) << "as of the last time";
  EXPECT_EQ(blobs_->Sweep({}, rules)->kept, 2u);
}

TEST_F(S3Test, ListsInPages) {
  S3Options options = server_->Options();
  options.page = 3;
  std::set<std::string> hashes;
  for (int i = 0; i < 10; ++i) hashes.insert("blobs/" + Put("blob " + std::to_string(i)));
  const auto list = S3Client(options).List("blobs/");
  ASSERT_TRUE(list) << list.error().message;
  std::set<std::string> keys;
  for (const S3Object& object : list->objects) {
    keys.insert(object.key);
    EXPECT_EQ(object.bytes, 6u);
    EXPECT_LE(std::abs(list->now - object.modified), 600);
  }
  EXPECT_EQ(keys, hashes);
}

TEST_F(S3Test, BelongsToOneStore) {
  const std::string one(32, 'a'), two(32, 'b');
  EXPECT_TRUE(blobs_->Claim(one));
  EXPECT_TRUE(blobs_->Claim(one));
  const Status other = blobs_->Claim(two);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().kind, FaultKind::kInvalidOption);
  EXPECT_NE(other.error().message.find("belong to another store"), std::string::npos);
  EXPECT_TRUE(blobs_->Claim(one));
}

TEST_F(S3Test, WhoMayNotIsToldAndSecretsStaySecret) {
  S3Options options = server_->Options();
  options.key_id = "N0BODY";
  options.secret = "wr0ng";
  const auto put = S3BlobStore(options, nullptr).Put(*Sha256Hex("x"), "x");
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable);
  EXPECT_NE(put.error().message.find("403"), std::string::npos) << put.error().message;
  EXPECT_EQ(put.error().message.find("wr0ng"), std::string::npos);
  const testing::TempDir dir;
  options.credentials_file = dir / "credentials";
  S3BlobStore blobs(options, nullptr);
  EXPECT_FALSE(blobs.Put(*Sha256Hex("x"), "x")) << "no such file";
  testing::Spill(options.credentials_file,
                 "aws_access_key_id = S3RVER\naws_secret_access_key = S3RVER\n");
  EXPECT_TRUE(blobs.Put(*Sha256Hex("x"), "x")) << "read again";
  options = server_->Options();
  options.bucket = "others";
  const auto got = S3BlobStore(options, nullptr).Get(*Sha256Hex("x"));
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().kind, FaultKind::kStoreUnavailable) << "no blob is lost for that";
}

TEST_F(S3Test, GoneIsSaidAndTheCacheGoesOn) {
  const testing::TempDir dir;
  S3BlobStore cached(server_->Options(), *BlobCache::Open(dir / "cache", kRoom), seconds(0));
  const std::string hash = *Sha256Hex("mesh"), other = Put("other");
  ASSERT_TRUE(cached.Put(hash, "mesh"));
  server_->Kill();
  EXPECT_EQ(cached.Get(hash), "mesh");
  for (const Status& done :
       {cached.Put(hash, "mesh"), Status(cached.Get(other).transform([](auto&&) {})),
        Status(cached.Sweep({}, {}).transform([](auto&&) {})),
        cached.Claim(std::string(32, 'a'))}) {
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, FaultKind::kStoreUnavailable);
    EXPECT_NE(done.error().message.find("cannot be reached"), std::string::npos);
  }
  server_->Restart();
  EXPECT_EQ(cached.Get(other), "other");
  testing::Smash(dir / ("cache/" + hash), 0, "x");
  EXPECT_EQ(cached.Get(hash), "mesh") << "from the store again";
}

TEST_F(S3Test, AServerKeepsItsMeshesThere) {
  const testing::TempDir dir;
  StoreOptions options;
  options.store = "sqlite:" + (dir / "state");
  options.blob_store = "s3://arapd/prod";
  options.blob_dir = dir / "cache";
  const S3Options s3 = server_->Options();
  options.s3.endpoint = s3.endpoint;
  options.s3.key_id = s3.key_id;
  options.s3.secret = s3.secret;
  auto stores = OpenStores(options);
  ASSERT_TRUE(stores) << stores.error().message;
  const std::string hash = *Sha256Hex("mesh");
  EXPECT_TRUE(stores->blobs->Put(hash, "mesh"));
  EXPECT_FALSE(fs::exists(dir / "state/blobs"));
  EXPECT_TRUE(fs::exists(dir / ("cache/" + hash)));
  stores = Fail(FaultKind::kInternal, "closed");
  options.store = "sqlite:" + (dir / "another");
  const auto foreign = OpenStores(options);
  ASSERT_FALSE(foreign) << "the meshes are the first one's";
  EXPECT_EQ(foreign.error().field, "blob_store");
}

}  // namespace
}  // namespace arap::store
