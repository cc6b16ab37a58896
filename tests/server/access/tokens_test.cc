// Token files: their form, whose tokens they hold, and what happens when they change.
#include "server/access/tokens.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_clock.h"
#include "tests/system/wire/token_fixture.h"

namespace arap::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using wire::TestToken;

Result<TokenFile> Parse(const std::string& json) {
  return TokenFile::Parse(json, "tokens.json", OwnerLimits{});
}

const TokenFile::Wall kNow = runtime::FakeClock().WallNow();

TEST(TokenFile, KnowsWhoseATokenIs) {
  const TestToken alice('a', "alice"), root('b', "root", "admin");
  const auto file = Parse("[" + alice.Entry() + "," + root.Entry() + "]");
  ASSERT_TRUE(file) << file.error().message;
  const auto caller = file->Check(alice.Text(), kNow);
  ASSERT_TRUE(caller);
  EXPECT_EQ(caller->owner, "alice");
  EXPECT_EQ(caller->role, Role::kUser);
  EXPECT_EQ(caller->limits, OwnerLimits{});
  EXPECT_EQ(file->Check(root.Text(), kNow)->role, Role::kAdmin);
}

TEST(TokenFile, AnswersAlikeForAWrongSecretAndAnUnknownId) {
  const TestToken alice('a', "alice"), stranger('c', "alice");
  const auto file = Parse("[" + alice.Entry() + "]");
  std::string wrong = alice.Text();
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  const auto secret = file->Check(wrong, kNow);
  const auto id = file->Check(stranger.Text(), kNow);
  ASSERT_FALSE(secret);
  ASSERT_FALSE(id);
  EXPECT_EQ(secret.error().kind, FaultKind::kUnauthenticated);
  EXPECT_EQ(secret.error().message, id.error().message);
  EXPECT_THAT(secret.error().message, Not(HasSubstr(wrong)));
  // What unknown ids are compared with lets nobody in.
  EXPECT_FALSE(file->Check("arapd_" + std::string(32, '0') + "_" + std::string(64, '0'), kNow));
}

TEST(TokenFile, RefusesWhatIsNoToken) {
  const TestToken alice('a', "alice");
  const auto file = Parse("[" + alice.Entry() + "]");
  const std::string good = alice.Text();
  std::string upper = good;
  upper[10] = 'A';
  for (const std::string& bad :
       {std::string(), std::string("arapd_"), good + "0", good.substr(1), upper,
        good.substr(0, good.size() - 1), std::string(good.size(), '_')}) {
    const auto caller = file->Check(bad, kNow);
    ASSERT_FALSE(caller) << bad;
    EXPECT_EQ(caller.error().kind, FaultKind::kUnauthenticated);
    EXPECT_EQ(TokenFile::IdOf(bad), "");
  }
  EXPECT_EQ(TokenFile::IdOf(good), std::string(32, 'a'));
}

TEST(TokenFile, TokensExpireAtTheirTime) {
  const TestToken alice('a', "alice");  // the fake clock starts on 2023-11-14 at 22:13:20
  const auto file = Parse("[" + alice.Entry(R"("expires": "2023-11-14T22:13:30Z")") + "]");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->Check(alice.Text(), kNow + std::chrono::milliseconds(9'999)));
  const auto late = file->Check(alice.Text(), kNow + std::chrono::seconds(10));
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("expired"));
}

TEST(TokenFile, ExpiriesMayBeFarAway) {
  const TestToken alice('a', "alice"), bob('b', "bob");
  const auto file = Parse("[" + alice.Entry(R"("expires": "9999-12-31T23:59:59Z")") + "," +
                          bob.Entry(R"("expires": "0000-01-01T00:00:00Z")") + "]");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->Check(alice.Text(), kNow));
  EXPECT_TRUE(file->Holds(TokenFile::IdOf(alice.Text()), "alice", kNow));
  EXPECT_FALSE(file->Check(bob.Text(), kNow));
  EXPECT_FALSE(file->Holds(TokenFile::IdOf(bob.Text()), "bob", kNow));
}

TEST(TokenFile, LimitsThatAreNotStatedAreTheServers) {
  const TestToken alice('a', "alice");
  const auto file = Parse(
      "[" + alice.Entry(R"("limits": {"max_sessions": 3, "max_bytes": 1000000000000})") + "]");
  ASSERT_TRUE(file) << file.error().message;
  const OwnerLimits limits = file->Check(alice.Text(), kNow)->limits;
  EXPECT_EQ(limits.max_sessions, 3u);
  EXPECT_EQ(limits.max_bytes, 1'000'000'000'000u);
  EXPECT_EQ(limits.max_streams, OwnerLimits{}.max_streams);
}

TEST(TokenFile, AGatewaySpeaksForItsUsers) {
  const TestToken studio('a', "studio", "gateway"), alice('b', "alice"), root('c', "root", "admin");
  const auto file = Parse("[" + studio.Entry(R"("limits": {"max_sessions": 50},
                                          "user_limits": {"max_sessions": 2})") +
                          "," + alice.Entry() + "," + root.Entry() + "]");
  ASSERT_TRUE(file) << file.error().message;
  const auto itself = file->Check(studio.Text(), kNow);
  ASSERT_TRUE(itself);
  EXPECT_EQ(itself->owner, "studio");
  EXPECT_EQ(itself->limits.max_sessions, 50u);
  const auto user = file->Check(studio.Text(), kNow, "mia");
  ASSERT_TRUE(user);
  EXPECT_EQ(user->owner, "studio/mia");
  EXPECT_EQ(user->role, Role::kUser);
  EXPECT_EQ(user->limits.max_sessions, 2u);
  ASSERT_TRUE(user->gateway);
  EXPECT_EQ(user->gateway->owner, "studio");
  EXPECT_EQ(user->gateway->limits.max_sessions, 50u);
  const std::string id(32, 'a');
  EXPECT_TRUE(file->Holds(id, "studio/mia", kNow));
  EXPECT_TRUE(file->Holds(id, "studio", kNow));
  EXPECT_FALSE(file->Holds(id, "studios/mia", kNow));
  EXPECT_FALSE(file->Holds(TokenFile::IdOf(alice.Text()), "alice/mia", kNow));

  for (const std::string& bad : {std::string(), std::string("a/b"), std::string(129, 'a')}) {
    const auto refused = file->Check(studio.Text(), kNow, bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().kind, FaultKind::kInvalidName);
    EXPECT_EQ(refused.error().field, "x-arapd-owner");
  }
  for (const TestToken& other : {alice, root}) {
    const auto refused = file->Check(other.Text(), kNow, "mia");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, FaultKind::kPermissionDenied);
  }
}

TEST(TokenFile, FaultsNameTheEntryAndTheField) {
  const TestToken good('a', "alice");
  struct Case {
    std::string entry;
    const char* field;
  };
  const std::vector<Case> cases{
      {"7", "[1].it"},
      {R"({"id": "ab"})", "[1].id"},
      {good.Entry(), "[1].id"},
      {TestToken('b', "").Entry(), "[1].owner"},
      {TestToken('b', "a/b").Entry(), "[1].owner"},
      {TestToken('b', kNobody).Entry(), "[1].owner"},
      {TestToken('b', "bob", "king").Entry(), "[1].role"},
      {TestToken('b', "bob").Entry(R"("user_limits": {})"), "[1].user_limits"},
      {TestToken('b', "bob", "gateway").Entry(R"("user_limits": {"max_cats": 1})"),
       "[1].user_limits.max_cats"},
      {TestToken('b', "bob").Entry(R"("salt": "xyz")"), "[1].salt"},
      {TestToken('b', "bob").Entry(R"("sha256": "xyz")"), "[1].sha256"},
      {TestToken('b', "bob").Entry(R"("expires": "tomorrow")"), "[1].expires"},
      {TestToken('b', "bob").Entry(R"("expires": "2023-02-30T00:00:00Z")"), "[1].expires"},
      {TestToken('b', "bob").Entry(R"("expires": 12)"), "[1].expires"},
      {TestToken('b', "bob").Entry(R"("expire": "2023-02-20T00:00:00Z")"), "[1].expire"},
      {TestToken('b', "bob").Entry(R"("limits": 3)"), "[1].limits"},
      {TestToken('b', "bob").Entry(R"("limits": {"max_sessions": -3})"), "[1].limits.max_sessions"},
      {TestToken('b', "bob").Entry(R"("limits": {"sessions": 3})"), "[1].limits.sessions"},
  };
  for (const Case& bad : cases) {
    const auto file = Parse("[" + good.Entry() + "," + bad.entry + "]");
    ASSERT_FALSE(file) << bad.entry;
    EXPECT_EQ(file.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(file.error().field, bad.field) << file.error().message;
    EXPECT_THAT(file.error().message, HasSubstr("tokens.json, entry 1"));
    EXPECT_THAT(file.error().message, Not(HasSubstr("xyz")));
  }
  for (const char* bad : {"", "{}", "[", "null", "[] []"}) EXPECT_FALSE(Parse(bad)) << bad;
  EXPECT_TRUE(Parse("[]"));
}

class TokensTest : public ::testing::Test {
 protected:
  std::shared_ptr<Tokens> Open() {
    auto tokens = Tokens::Open(path(), OwnerLimits{}, clock_);
    EXPECT_TRUE(tokens) << tokens.error().message;
    return tokens ? *tokens : nullptr;
  }

  std::string path() const { return folder_.tokens(); }
  void Write(const std::vector<std::string>& entries) const { folder_.PutTokens(entries); }

  const wire::SecretFolder folder_;
  runtime::FakeClock clock_;
  const TestToken alice_{'a', "alice"};
  const TestToken bob_{'b', "bob"};
};

TEST_F(TokensTest, RefusesAFileThatOthersMayRead) {
  Write({alice_.Entry()});
  using std::filesystem::perms;
  for (const perms open : {perms::others_read, perms::group_write, perms::others_write}) {
    std::filesystem::permissions(path(), perms::owner_read | perms::group_read | open);
    const auto tokens = Tokens::Open(path(), OwnerLimits{}, clock_);
    ASSERT_FALSE(tokens);
    EXPECT_THAT(tokens.error().message, HasSubstr("chmod"));
  }
  std::filesystem::permissions(path(), perms::owner_read | perms::group_read);
  EXPECT_TRUE(Open());
}

TEST_F(TokensTest, MissingFileIsNamed) {
  const auto tokens = Tokens::Open(path(), OwnerLimits{}, clock_);
  ASSERT_FALSE(tokens);
  EXPECT_THAT(tokens.error().message, HasSubstr(path()));
}

TEST_F(TokensTest, ReloadTakesTheNewFileAndKeepsTheOldOneInsteadOfABadOne) {
  Write({alice_.Entry()});
  const auto tokens = Open();
  Write({bob_.Entry()});
  EXPECT_TRUE(tokens->Check(alice_.Text()));
  ASSERT_TRUE(tokens->Reload());
  EXPECT_FALSE(tokens->Check(alice_.Text()));
  EXPECT_TRUE(tokens->Check(bob_.Text()));
  Write({"broken"});
  const auto reloaded = tokens->Reload();
  ASSERT_FALSE(reloaded);
  EXPECT_THAT(reloaded.error().message, HasSubstr(path()));
  EXPECT_TRUE(tokens->Check(bob_.Text()));
}

TEST_F(TokensTest, RefreshLooksOnlyAtFilesThatChanged) {
  Write({alice_.Entry()});
  const auto tokens = Open();
  EXPECT_EQ(tokens->Refresh().value(), false);
  Write({alice_.Entry(), bob_.Entry()});
  EXPECT_EQ(tokens->Refresh().value(), true);
  EXPECT_EQ(tokens->size(), 2u);
  EXPECT_EQ(tokens->Refresh().value(), false);
  Write({"broken"});
  EXPECT_FALSE(tokens->Refresh());
  EXPECT_EQ(tokens->Refresh().value(), false);  // said once
  EXPECT_EQ(tokens->size(), 2u);
}

TEST_F(TokensTest, WatchersHearOfRevokedTokensOnce) {
  Write({alice_.Entry(), bob_.Entry()});
  const auto tokens = Open();
  std::vector<std::string> lost;
  const auto watch = [&](const TestToken& token, const std::string& owner, const char* name) {
    return tokens->Watch(TokenFile::IdOf(token.Text()), owner, [&lost, name](const Fault& fault) {
      EXPECT_EQ(fault.kind, FaultKind::kUnauthenticated);
      lost.emplace_back(name);
    });
  };
  const auto first = watch(alice_, "alice", "alice");
  const auto second = watch(bob_, "bob", "bob");
  { const auto gone = watch(alice_, "alice", "gone"); }
  EXPECT_THAT(lost, testing::IsEmpty());
  Write({bob_.Entry()});
  ASSERT_TRUE(tokens->Reload());
  EXPECT_THAT(lost, testing::ElementsAre("alice"));
  ASSERT_TRUE(tokens->Reload());
  EXPECT_THAT(lost, testing::ElementsAre("alice"));
  // Nothing to wait for: it is told at once.
  const auto late = watch(alice_, "alice", "late");
  const auto other = watch(bob_, "alice", "other");
  EXPECT_THAT(lost, testing::ElementsAre("alice", "late", "other"));
}

TEST_F(TokensTest, WatchersHearOfExpiredTokens) {
  Write({alice_.Entry(R"("expires": "2023-11-14T22:13:30Z")")});
  const auto tokens = Open();
  int lost = 0;
  const auto watch =
      tokens->Watch(TokenFile::IdOf(alice_.Text()), "alice", [&](const Fault&) { ++lost; });
  EXPECT_EQ(tokens->Refresh().value(), false);
  EXPECT_EQ(lost, 0);
  clock_.Advance(std::chrono::seconds(10));
  EXPECT_EQ(tokens->Refresh().value(), false);
  EXPECT_EQ(lost, 1);
}

}  // namespace
}  // namespace arap::app
