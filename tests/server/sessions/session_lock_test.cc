// Calls that meet on one session, and calls that must not wait for each other.
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/sessions/session_locks.h"
#include "server/sessions/session_registry.h"
#include "tests/server/sessions/gated_store.h"
#include "tests/support/bounded.h"
#include "tests/support/fake_clock.h"

namespace arap::app {
namespace {

using std::chrono::minutes;
using testing::Answer;
using testing::Await;
using testing::GatedStore;
using Call = GatedStore::Call;

template <class T>
bool IsReady(const std::future<T>& future) {
  return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

template <class Function>
auto InThread(Function function) {
  return std::async(std::launch::async, std::move(function));
}

class SessionLockTest : public ::testing::Test {
 protected:
  static constexpr const char* kId = "s";

  Result<SessionView> Create(const Caller& caller, const std::string& id = kId) {
    return sessions_.Create(caller, {id, minutes(60), {}});
  }
  // As a process before this one has left it: stored, but not in memory.
  void Store(const Caller& caller) {
    SessionRegistry before(limits_, clock_, store_, memory_, [](const store::SessionRecord&) {});
    ASSERT_TRUE(before.Create(caller, {kId, minutes(60), {}}));
  }
  Result<Session::Record> AddMesh(const Caller& caller, const std::string& id,
                                  const std::string& mesh) {
    auto session = sessions_.Use(caller.owner, id);
    if (!session) return Fail(session.error());
    return sessions_.Change(caller, **session, [&](store::SessionRecord& record) {
      record.meshes[mesh] = {"0"};
      return Result<bool>(true);
    });
  }
  // Lets the held call go on once `other` has ended or waits for a session's lock.
  template <class T>
  void Meet(const std::future<T>& other) {
    EXPECT_TRUE(Await("the second call to end or to wait for the first",
                      [&] { return IsReady(other) || sessions_.waiting() > 0; }));
    store_.LetGo();
  }
  bool IsStored(const Caller& caller, const std::string& id = kId) {
    return store_.Version({caller.owner, id})->has_value();
  }

  const Caller ann_{"ann", Role::kUser, {}};
  const Caller ben_{"ben", Role::kUser, {}};
  const Limits limits_{};
  runtime::FakeClock clock_;
  GatedStore store_;
  DerivedCache memory_{limits_.max_bytes, {}, clock_};
  SessionRegistry sessions_{limits_, clock_, store_, memory_, [](const store::SessionRecord&) {}};
};

TEST_F(SessionLockTest, AChangeThatIsForestalledIsTriedAgain) {
  ASSERT_TRUE(Create(ann_));
  store_.Forestall(3);
  ASSERT_TRUE(AddMesh(ann_, kId, "m"));
  EXPECT_EQ(store_.forestalled(), 0);
  EXPECT_EQ(store_.Load({"ann", kId})->value().meshes.count("m"), 1u);
}

TEST_F(SessionLockTest, AChangeThatIsForestalledForEverEnds) {
  ASSERT_TRUE(Create(ann_));
  constexpr int kMany = 1'000;
  store_.Forestall(kMany);
  const auto changed = AddMesh(ann_, kId, "m");
  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().kind, FaultKind::kStoreUnavailable);
  EXPECT_EQ(DetailOf(changed.error(), "tries"), "16");
  EXPECT_GT(InfoOf(changed.error().kind).retry.count(), 0);
  EXPECT_EQ(store_.forestalled(), kMany - 16);
  // Nothing is left behind: neither the change nor the lock.
  store_.Forestall(0);
  EXPECT_TRUE(store_.Load({"ann", kId})->value().meshes.empty());
  EXPECT_TRUE(AddMesh(ann_, kId, "n"));
}

TEST_F(SessionLockTest, DeletedWhileItIsLoadedItStaysAway) {
  ASSERT_NO_FATAL_FAILURE(Store(ann_));
  store_.HoldUp(Call::kLoad, {"ann", kId});
  auto used = InThread([&] { return sessions_.Use("ann", kId); });
  store_.AwaitHeldCall();
  auto deleted = InThread([&] { return sessions_.Delete("ann", kId); });
  Meet(deleted);
  static_cast<void>(Answer(used, "the look-up"));
  EXPECT_TRUE(Answer(deleted, "the deletion"));
  EXPECT_EQ(sessions_.in_memory(), 0u);
  EXPECT_FALSE(sessions_.Use("ann", kId));
  EXPECT_TRUE(Create(ann_));
  EXPECT_TRUE(IsStored(ann_)) << "who creates it anew is not answered with the dead one";
}

TEST_F(SessionLockTest, CreatedWhileItIsDeletedItIsStored) {
  ASSERT_TRUE(Create(ann_));
  store_.HoldUp(Call::kRemove, {"ann", kId});
  auto deleted = InThread([&] { return sessions_.Delete("ann", kId); });
  store_.AwaitHeldCall();
  auto created = InThread([&] { return Create(ann_); });
  Meet(created);
  EXPECT_TRUE(Answer(deleted, "the deletion"));
  EXPECT_TRUE(Answer(created, "the creation"));
  EXPECT_TRUE(IsStored(ann_));
  EXPECT_TRUE(sessions_.Use("ann", kId));
}

TEST_F(SessionLockTest, TwoThatCreateItGetTheSame) {
  store_.HoldUp(Call::kPut, {"ann", kId});
  auto first = InThread([&] { return Create(ann_); });
  store_.AwaitHeldCall();
  auto second = InThread([&] { return Create(ann_); });
  Meet(second);
  EXPECT_TRUE(Answer(first, "the first call"));
  EXPECT_TRUE(Answer(second, "the second call"));
  EXPECT_EQ(store_.UsageOf("ann")->sessions, 1u);
}

TEST_F(SessionLockTest, AChangeComesBeforeTheDeletionOrFindsItGone) {
  ASSERT_TRUE(Create(ann_));
  store_.HoldUp(Call::kRemove, {"ann", kId});
  auto deleted = InThread([&] { return sessions_.Delete("ann", kId); });
  store_.AwaitHeldCall();
  auto changed = InThread([&] { return AddMesh(ann_, kId, "m"); });
  Meet(changed);
  EXPECT_TRUE(Answer(deleted, "the deletion"));
  const auto answer = Answer(changed, "the change");
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, FaultKind::kNotFound);
  EXPECT_FALSE(IsStored(ann_));
}

TEST_F(SessionLockTest, TheSweepLeavesABusySessionForTheNextOne) {
  ASSERT_TRUE(Create(ann_));
  ASSERT_TRUE(Create(ann_, "other"));
  clock_.Advance(minutes(61));
  store_.HoldUp(Call::kRemove, {"ann", kId});
  auto viewed = InThread([&] { return sessions_.View("ann", kId); });
  store_.AwaitHeldCall();
  ASSERT_TRUE(sessions_.Sweep());
  EXPECT_FALSE(IsStored(ann_, "other"));
  EXPECT_TRUE(sessions_.List("ann", 0, "")->sessions.empty()) << "an expired one is not shown";
  store_.LetGo();
  EXPECT_FALSE(Answer(viewed, "the look"));
  EXPECT_EQ(sessions_.in_memory(), 0u);
}

// Whatever holds up a call on ann's session, ben's calls go on.
TEST_F(SessionLockTest, SessionsDoNotWaitForEachOthersStore) {
  for (const Call held : {Call::kLoad, Call::kPut, Call::kRemove}) {
    ASSERT_NO_FATAL_FAILURE(Store(ann_));
    if (held != Call::kLoad) {
      ASSERT_TRUE(sessions_.Use("ann", kId));
    }
    store_.HoldUp(held, {"ann", kId});
    auto slow = InThread([&] {
      if (held == Call::kLoad) static_cast<void>(sessions_.Use("ann", kId));
      if (held == Call::kPut) static_cast<void>(AddMesh(ann_, kId, "m"));
      return sessions_.Delete("ann", kId);
    });
    store_.AwaitHeldCall();
    auto life = InThread([&] {
      EXPECT_TRUE(Create(ben_));
      EXPECT_TRUE(AddMesh(ben_, kId, "m"));
      EXPECT_TRUE(sessions_.View("ben", kId));
      EXPECT_EQ(sessions_.List("ben", 0, "")->sessions.size(), 1u);
      EXPECT_TRUE(sessions_.Delete("ben", kId));
      EXPECT_TRUE(Create(ann_, "t")) << "another session of the same owner";
      EXPECT_TRUE(sessions_.Delete("ann", "t"));
      EXPECT_TRUE(sessions_.Sweep());
    });
    EXPECT_TRUE(Await("ben's calls to end", [&] { return IsReady(life); }));
    EXPECT_FALSE(IsReady(slow));
    store_.LetGo();
    EXPECT_TRUE(Answer(slow, "the call that was held up"));
  }
}

TEST_F(SessionLockTest, ThoseThatMeetDoNotExceedAQuota) {
  Caller small = ann_;
  small.limits.max_sessions = 2;
  small.limits.max_meshes = 1;
  ASSERT_TRUE(Create(small, "a"));
  store_.HoldUp(Call::kPut, {"ann", "b"});
  auto first = InThread([&] { return Create(small, "b"); });
  store_.AwaitHeldCall();
  auto second = InThread([&] { return Create(small, "c"); });
  EXPECT_TRUE(Create(ben_)) << "somebody else's places";
  store_.LetGo();
  EXPECT_TRUE(Answer(first, "the first call")) << "whoever comes first has the place";
  const auto refused = Answer(second, "the second call");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);

  store_.HoldUp(Call::kPut, {"ann", "a"});
  auto mesh = InThread([&] { return AddMesh(small, "a", "m"); });
  store_.AwaitHeldCall();
  auto other = InThread([&] { return AddMesh(small, "b", "m"); });
  store_.LetGo();
  EXPECT_TRUE(Answer(mesh, "the first mesh"));
  EXPECT_FALSE(Answer(other, "the second mesh"));
  EXPECT_EQ(store_.UsageOf("ann")->meshes, 1u);
}

// A place that the store counts already, while its call has not ended, costs nobody the last one.
TEST_F(SessionLockTest, NobodyIsRefusedForAPlaceThatIsCountedTwice) {
  OwnerQuotas quotas(limits_, store_);
  Caller small = ann_;
  small.limits.max_sessions = 2;
  auto first = std::make_unique<Result<OwnerQuotas::Place>>(quotas.Take(small, {.sessions = 1}));
  ASSERT_TRUE(*first);
  ASSERT_NO_FATAL_FAILURE(Store(ann_));
  auto second = InThread([&] { return quotas.Take(small, {.sessions = 1}).has_value(); });
  first.reset();
  EXPECT_TRUE(Answer(second, "the second call"));
}

TEST(SessionLocksTest, OneAtATimeAndNothingLeftBehind) {
  SessionLocks locks;
  int inside = 0;
  std::vector<std::future<void>> threads;
  for (int i = 0; i < 4; ++i) {
    threads.push_back(InThread([&] {
      for (int round = 0; round < 1000; ++round) {
        const auto held = locks.Take({"ann", "s"});
        EXPECT_EQ(++inside, 1);
        --inside;
      }
    }));
  }
  for (auto& thread : threads) Answer(thread, "the threads");
  EXPECT_EQ(locks.waiting(), 0u);
  const auto held = locks.TryTake({"ann", "s"});
  EXPECT_TRUE(held);
  EXPECT_FALSE(locks.TryTake({"ann", "s"}));
  EXPECT_TRUE(locks.TryTake({"ann", "t"}));
}

TEST_F(SessionLockTest, WhoHasAllItMayHaveDoesNotWaitForOthers) {
  Caller ann = ann_;
  ann.limits.max_sessions = 1;
  ASSERT_TRUE(Create(ann));
  store_.HoldUp(Call::kPut, {"ben", kId});
  auto bens = InThread([&] { return Create(ben_); });
  store_.AwaitHeldCall();
  auto second = InThread([&] { return Create(ann, "t"); });
  const auto refused = Answer(second, "the refusal");
  store_.LetGo();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().details.front().second, "max_sessions_per_owner");
  EXPECT_TRUE(Answer(bens, "ben's session"));
}

}  // namespace
}  // namespace arap::app
