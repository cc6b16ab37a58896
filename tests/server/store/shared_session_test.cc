// A session that two servers have in memory, over one Redis.
#include <chrono>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "server/sessions/session_registry.h"
#include "server/store/open_store.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/temp_dir.h"
#include "tests/support/fake_clock.h"

namespace arap::app {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

struct Server {
  Server(const testing::RedisServer& redis, const runtime::Clock& clock,
         const testing::TempDir& dir) {
    store::StoreOptions options;
    options.store = redis.Url();
    options.blob_dir = dir / "blobs";
    auto opened = store::OpenStores(options);
    EXPECT_TRUE(opened) << opened.error().message;
    stores = *std::move(opened);
    sessions.emplace(limits, clock, *stores.specs, [](const store::SessionRecord&) {});
  }

  const Limits limits{};
  store::Stores stores;
  std::optional<SessionRegistry> sessions;
};

class SharedSessionTest : public ::testing::Test {
 protected:
  // A session of ann, in use at the second server.
  void SetUp() override {
    ASSERT_TRUE(first_.sessions->Create({"ann", Role::kUser, {}}, {"s", minutes(60), {}}));
    auto session = second_.sessions->Use("ann", "s");
    ASSERT_TRUE(session);
    session_ = *session;
    session_->AddEndListener([this] { ended_ = true; });
  }
  // As a stream does with every update.
  void GoOn(seconds time) {
    clock_.Advance(time);
    ASSERT_TRUE(session_->Touch());
    ASSERT_TRUE(second_.sessions->Sweep());
  }

  testing::TempDir dir_;
  testing::RedisServer redis_;
  runtime::FakeClock clock_;
  Server first_{redis_, clock_, dir_};
  Server second_{redis_, clock_, dir_};
  std::shared_ptr<Session> session_;
  bool ended_ = false;
};

TEST_F(SharedSessionTest, DeletedByOneEndsItsStreamsAtTheOther) {
  ASSERT_TRUE(first_.sessions->Delete("ann", "s"));
  GoOn(seconds(16));
  EXPECT_TRUE(ended_) << "when its expiry is to be stored, at the latest";
  EXPECT_FALSE(session_->Touch());
  EXPECT_EQ(second_.sessions->in_memory(), 0u);
}

TEST_F(SharedSessionTest, UsedAtOneLivesOnAtTheOther) {
  for (int i = 0; i < 8; ++i) ASSERT_NO_FATAL_FAILURE(GoOn(minutes(10)));
  EXPECT_FALSE(ended_);
  EXPECT_TRUE(first_.sessions->Use("ann", "s"));
}

}  // namespace
}  // namespace arap::app
