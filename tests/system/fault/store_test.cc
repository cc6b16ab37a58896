// Stores that fill up, cannot be written or are damaged, below the real server: clear errors, no
// crash, the others go on, and nobody has to repair anything.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/support/random.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/ledger.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kIds{"a", "b"};

class StoreTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directory(disk()); }

  // A disk of its own below the store, so that it can be full or read-only. Skips the test where
  // that is not allowed.
  void Mount(const char* size) {
    if (mount("arap-fault", disk().c_str(), "tmpfs", 0, size) != 0) {
      GTEST_SKIP() << "cannot mount: " << std::strerror(errno);  // NOLINT(concurrency-mt-unsafe)
    }
    mounted_ = true;
  }
  void TearDown() override {
    server_.Kill();
    EXPECT_TRUE(!mounted_ || umount2(disk().c_str(), MNT_DETACH) == 0);
  }

  void Restart() {
    server_.Kill();
    ASSERT_TRUE(server_.Start());
    client_.emplace(server_.address());
  }

  // A session with the mesh "m" and the set "h"; other sizes are other blobs.
  void Fill(const std::string& session, int size) {
    ASSERT_TRUE(client_->CreateSession(session).ok());
    ASSERT_TRUE(client_->Register(session, "m", wire::Grid(size, size)).ok());
    ASSERT_TRUE(
        client_
            ->Compile(session, "m", "h", {wire::VertexHandle("a", 0), wire::VertexHandle("b", 2)})
            .ok());
  }

  // The bytes that the session answers; a failure of the test when it does not.
  std::string Answer(const std::string& session) {
    v1::DeformResponse response;
    const grpc::Status status = client_->Deform(session, "h", FixedTargets(kIds), &response);
    EXPECT_TRUE(status.ok()) << session << ": " << status.error_message();
    return BytesOf(response.shape());
  }

  std::string disk() const { return server_.folder() / "disk"; }
  std::string store() const { return disk() + "/store"; }

  // The largest file of the blobs.
  fs::path LargestBlob() const {
    fs::path largest;
    std::uintmax_t size = 0;
    for (const auto& entry : fs::recursive_directory_iterator(store() + "/blobs")) {
      if (!entry.is_regular_file() || entry.file_size() <= size) continue;
      largest = entry.path();
      size = entry.file_size();
    }
    return largest;
  }

  ServerProcess server_{{"--store", "sqlite:{}/disk/store"}};
  std::optional<FaultClient> client_;
  bool mounted_ = false;
};

TEST_F(StoreTest, AFullDiskRefusesAndRecovers) {
  Mount("size=2m");
  if (IsSkipped()) return;
  Restart();
  Fill("kept", 4);
  const std::string before = Answer("kept");
  {
    std::ofstream filler(disk() + "/filler", std::ios::binary);
    const std::string block(4'096, 'x');
    while (filler.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
    }
  }
  wire::ExpectError(client_->Register("kept", "new", wire::Grid(40, 40)), grpc::UNAVAILABLE,
                    "STORE_UNAVAILABLE");
  EXPECT_EQ(Answer("kept"), before);

  fs::remove(disk() + "/filler");
  EXPECT_TRUE(
      Eventually([&] { return client_->Register("kept", "new", wire::Grid(40, 40)).ok(); }));
  Restart();
  EXPECT_EQ(Answer("kept"), before);
  const MaybeSession kept = ReadSession(*client_, "kept");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->meshes.size(), 2u);
}

TEST_F(StoreTest, AReadOnlyDiskIsAClearEndOrAClearAnswer) {
  Mount("size=8m");
  if (IsSkipped()) return;
  Restart();
  Fill("kept", 4);
  const std::string before = Answer("kept");
  server_.Kill();
  ASSERT_EQ(mount("", disk().c_str(), "", MS_REMOUNT | MS_RDONLY, nullptr), 0);
  const auto code = server_.StartAndFail();
  ASSERT_TRUE(code) << "it serves from a disk that it cannot write";
  EXPECT_GT(*code, 0);
  EXPECT_LT(*code, 128) << "it crashed:\n" << server_.Log();
  EXPECT_NE(server_.Log().find(store()), std::string::npos) << server_.Log();

  ASSERT_EQ(mount("", disk().c_str(), "", MS_REMOUNT, nullptr), 0);
  Restart();
  EXPECT_EQ(Answer("kept"), before);
}

TEST_F(StoreTest, ATruncatedBlobIsTheLossOfItsSessionsAlone) {
  Restart();
  Fill("small", 3);
  Fill("large", 20);
  const std::string small = Answer("small"), large = Answer("large");
  server_.Kill();
  const fs::path blob = LargestBlob();
  fs::resize_file(blob, fs::file_size(blob) / 2);

  Restart();
  wire::ExpectError(client_->Deform("large", "h", FixedTargets(kIds)), grpc::DATA_LOSS,
                    "DATA_LOSS");
  EXPECT_EQ(Answer("small"), small);
  EXPECT_TRUE(client_->CreateSession("new").ok());

  // The client has the mesh: sending it again mends everything.
  ASSERT_TRUE(client_->DeleteSession("large").ok());
  Fill("large", 20);
  EXPECT_EQ(Answer("large"), large);
}

TEST_F(StoreTest, CorruptPagesCostWhatWasInThemAtMost) {
  testing::Random random(11);
  Restart();
  std::vector<std::string> sessions, answers;
  for (int i = 0; i < 40; ++i) {
    sessions.push_back("s" + std::to_string(i));
    Fill(sessions.back(), 2 + i % 3);
    answers.push_back(Answer(sessions.back()));
  }
  // The orderly end writes the log into the database.
  client_.reset();
  server_.Signal(SIGTERM);
  ASSERT_EQ(server_.Wait(std::chrono::seconds(30)), 0);

  const std::string database = store() + "/sessions.db";
  constexpr std::size_t kPage = 4'096;
  const std::size_t pages = fs::file_size(database) / kPage;
  ASSERT_GT(pages, 8u);
  {
    std::fstream file(database, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(kPage * (2 + random.Below(pages - 2))));
    for (std::size_t i = 0; i < kPage; ++i) file.put(static_cast<char>(random.Below(256)));
  }
  Restart();
  std::size_t lost = 0;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    v1::DeformResponse response;
    const grpc::Status status = client_->Deform(sessions[i], "h", FixedTargets(kIds), &response);
    if (status.ok()) {
      EXPECT_EQ(BytesOf(response.shape()), answers[i]) << sessions[i];
      continue;
    }
    ++lost;
    EXPECT_TRUE(status.error_code() == grpc::DATA_LOSS || status.error_code() == grpc::NOT_FOUND)
        << sessions[i] << ": " << status.error_code() << ' ' << status.error_message();
  }
  EXPECT_LT(lost, sessions.size() / 2);
  EXPECT_NE(server_.Log().find("corrupt"), std::string::npos) << server_.Log();

  // Life goes on, and the next start finds a database in order.
  Fill("new", 5);
  const std::string answer = Answer("new");
  Restart();
  EXPECT_EQ(Answer("new"), answer);
}

}  // namespace
}  // namespace arap::fault
