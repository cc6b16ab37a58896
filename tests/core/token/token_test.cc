// Tokens, digests and names: what the server and arapctl must understand alike. That a damaged file
// is refused, field by field, is in tests/server/access/tokens_test.cc.
#include "core/token/token.h"

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/files.h"
#include "core/base/names.h"
#include "core/token/digest.h"
#include "tests/support/folder.h"

namespace arap {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

TEST(Sha256, GivesTheDigestsOfTheStandard) {
  EXPECT_EQ(Sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_TRUE(SameDigest("ab", "ab"));
  EXPECT_FALSE(SameDigest("ab", "ac"));
  EXPECT_FALSE(SameDigest("ab", "abc"));
}

TEST(HexDigits, AreLowerCaseAndCounted) {
  const std::vector<unsigned char> bytes{0x00, 0x9f, 0xe1};
  EXPECT_EQ(Hex(bytes), "009fe1");
  EXPECT_TRUE(IsHex("009fe1", 6));
  EXPECT_FALSE(IsHex("009fe1", 5));
  EXPECT_FALSE(IsHex("009fE1", 6));
  EXPECT_TRUE(IsHex("", 0));
}

TEST(Names, HaveOneRule) {
  EXPECT_TRUE(IsName("Az09._-"));
  EXPECT_TRUE(IsName(std::string(kMaxNameLength, 'x')));
  for (const std::string& bad : {std::string(), std::string("a/b"), std::string("a b"),
                                 std::string("é"), std::string(kMaxNameLength + 1, 'x')}) {
    EXPECT_FALSE(IsName(bad)) << bad;
    const Status checked = CheckName(bad, "id");
    ASSERT_FALSE(checked) << bad;
    EXPECT_EQ(checked.error().kind, FaultKind::kInvalidName);
    EXPECT_EQ(checked.error().field, "id");
  }
}

TEST(Token, IsMadeOfAnIdAndASecretThatItsEntryProves) {
  const auto token = MakeToken();
  ASSERT_TRUE(token) << token.error().message;
  EXPECT_THAT(token->text, MatchesRegex("arapd_[0-9a-f]{32}_[0-9a-f]{64}"));
  const auto parts = SplitToken(token->text);
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->id, token->id);
  EXPECT_EQ(HashSecret(token->salt, parts->secret), token->sha256);
  EXPECT_EQ(HashSecret(token->salt, parts->secret),
            Sha256Hex(token->salt + std::string(parts->secret)));
  EXPECT_NE(MakeToken()->text, token->text);
}

TEST(TokenFile, IsReadAsItWasWritten) {
  const auto user = MakeToken(), admin = MakeToken(), hub = MakeToken();
  ASSERT_TRUE(user && admin && hub);
  std::vector<TokenEntry> entries(3);
  entries[0] = {user->id, "alice", TokenRole::kUser, user->salt, user->sha256, {}, {}, {}};
  entries[1] = {admin->id, "root", TokenRole::kAdmin, admin->salt, admin->sha256, {}, {}, {}};
  entries[2] = {hub->id, "hub", TokenRole::kGateway, hub->salt, hub->sha256, {}, {}, {}};
  entries[2].limits = {{"max_sessions", 50}};
  entries[2].user_limits = {{"max_sessions", 5}};
  entries[1].expires = std::chrono::sys_days(std::chrono::year(2027) / 1 / 31) +
                       std::chrono::hours(13) + std::chrono::seconds(7);
  entries[1].limits = {{"max_sessions", 3}, {"max_bytes", 1'000'000'000'000}};
  const std::string text = FormatTokenFile(entries);
  EXPECT_THAT(text, HasSubstr(R"("expires": "2027-01-31T13:00:07Z")"));
  EXPECT_THAT(text, Not(HasSubstr(user->text.substr(user->text.rfind('_') + 1))));
  const auto read = ParseTokenFile(text, "tokens.json");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 3u);
  EXPECT_EQ((*read)[2].role, TokenRole::kGateway);
  EXPECT_EQ((*read)[2].limits, entries[2].limits);
  EXPECT_EQ((*read)[2].user_limits, entries[2].user_limits);
  EXPECT_EQ((*read)[0].owner, "alice");
  EXPECT_EQ((*read)[0].role, TokenRole::kUser);
  EXPECT_FALSE((*read)[0].expires);
  EXPECT_EQ((*read)[1].role, TokenRole::kAdmin);
  EXPECT_EQ((*read)[1].expires, entries[1].expires);
  EXPECT_EQ((*read)[1].limits, entries[1].limits);
  EXPECT_EQ(FormatTokenFile(*read), text);
  EXPECT_EQ(FormatTokenFile({}), "[]\n");
}

TEST(TokenFile, ExpiriesOfAllYearsAreWrittenAsTheyWereRead) {
  const auto token = MakeToken();
  ASSERT_TRUE(token);
  TokenEntry entry{token->id, "alice", TokenRole::kUser, token->salt, token->sha256, {}, {}, {}};
  entry.expires = std::chrono::sys_days(std::chrono::year(2027) / 1 / 31);
  const std::string written = FormatTokenFile(std::vector{entry});
  for (const std::string expires :
       {"0000-01-01T00:00:00Z", "0999-12-31T00:00:01Z", "1600-02-29T23:59:59Z",
        "2262-04-11T23:47:17Z", "9999-12-31T23:59:59Z"}) {
    std::string text = written;
    text.replace(text.find("2027-"), expires.size(), expires);
    const auto read = ParseTokenFile(text, "tokens.json");
    ASSERT_TRUE(read) << expires;
    EXPECT_EQ(FormatTokenFile(*read), text);
  }
}

TEST(TokenFile, DamagedEntriesAreReadAndWrittenAsTheyStand) {
  const auto token = MakeToken();
  ASSERT_TRUE(token);
  const TokenEntry good{token->id, "alice", TokenRole::kUser, token->salt, token->sha256, {},
                        {},        {}};
  std::string text = FormatTokenFile(std::vector{good, good});
  text.replace(text.rfind("\n]"), 2, R"(,
  7,
  {
    "owner": "b/b",
    "note": [
      1.5
    ],
    "id": "x"
  }
])");
  const auto raw = ParseRawTokenFile(text, "tokens.json");
  ASSERT_TRUE(raw) << raw.error().message;
  ASSERT_EQ(raw->size(), 4u);
  EXPECT_TRUE((*raw)[0].entry);
  const std::vector<std::string> fields{"[1].id", "[2].it", "[3].note"};
  for (std::size_t i = 1; i < 4; ++i) {
    ASSERT_FALSE((*raw)[i].entry) << i;
    EXPECT_EQ((*raw)[i].entry.error().field, fields[i - 1]);
  }
  EXPECT_EQ((*raw)[1].id, token->id);
  EXPECT_EQ((*raw)[2].id, "");
  EXPECT_EQ((*raw)[3].id, "x");
  EXPECT_EQ((*raw)[3].owner, "b/b");
  EXPECT_EQ(FormatRawTokenFile(*raw), text);
  EXPECT_EQ(ParseTokenFile(text, "tokens.json").error().field, "[1].id");
  EXPECT_FALSE(ParseRawTokenFile("{}", "tokens.json"));
}

TEST(TokenFile, FaultsNameTheEntryAndTheField) {
  const auto token = MakeToken();
  ASSERT_TRUE(token);
  const TokenEntry entry{token->id, "alice", TokenRole::kUser, token->salt, token->sha256, {},
                         {},        {}};
  const auto twice = ParseTokenFile(FormatTokenFile(std::vector{entry, entry}), "tokens.json");
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(twice.error().field, "[1].id");
  EXPECT_THAT(twice.error().message, HasSubstr("tokens.json, entry 1"));
  for (const char* bad : {"", "{}", "[1]", R"([{"id": "a", "note": "x"}])"}) {
    EXPECT_FALSE(ParseTokenFile(bad, "tokens.json")) << bad;
  }
}

using ChangeTokenFileTest = FolderTest;

TEST_F(ChangeTokenFileTest, ProcessesThatMeetWaitForEachOther) {
  const std::string path = Path("tokens.json");
  constexpr int kProcesses = 20;
  std::vector<pid_t> children;
  for (int i = 0; i < kProcesses; ++i) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      const auto token = MakeToken();
      const auto append = [&](const std::optional<std::string>& text) -> Result<std::string> {
        std::vector<TokenEntry> entries;
        if (text) entries = ParseTokenFile(*text, path).value_or(entries);
        entries.push_back(
            {token->id, "ann", TokenRole::kUser, token->salt, token->sha256, {}, {}, {}});
        return FormatTokenFile(entries);
      };
      _exit(token && ChangeTokenFile(path, append) ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  std::string text;
  ASSERT_EQ(ReadWhole(path, text), 0);
  const auto entries = ParseTokenFile(text, path);
  ASSERT_TRUE(entries) << entries.error().message;
  EXPECT_EQ(entries->size(), static_cast<std::size_t>(kProcesses));
  // A change that fails changes nothing.
  EXPECT_FALSE(ChangeTokenFile(path, [](const std::optional<std::string>&) -> Result<std::string> {
    return Fail(FaultKind::kNotFound, "There is no such token.");
  }));
  std::string after;
  EXPECT_EQ(ReadWhole(path, after), 0);
  EXPECT_EQ(after, text);
}

}  // namespace
}  // namespace arap
