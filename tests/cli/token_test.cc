// arapctl token against the server's own reader, and the flags that say who is asking.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <sstream>

#include <gmock/gmock.h>

#include "server/access/tokens.h"
#include "server/host/host.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using std::filesystem::perms;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

class TokenCommand : public FolderTest {
 protected:
  std::string file() const { return Path("tokens.json"); }
  // Makes a token and answers it.
  std::string Add(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"token", "add", "--file", file(), "--owner"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = Arapctl(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::string token = outcome.out;
    EXPECT_THAT(token, MatchesRegex("arapd_[0-9a-f]{32}_[0-9a-f]{64}\n"));
    token.pop_back();
    EXPECT_THAT(outcome.err, Not(HasSubstr(token)));
    return token;
  }
  // As the server reads it.
  app::TokenFile Read() const {
    auto read = app::TokenFile::Read(file(), OwnerLimits{});
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(app::TokenFile());
  }
  static Result<app::Caller> Check(const app::TokenFile& tokens, const std::string& token) {
    return tokens.Check(token, std::chrono::system_clock::now());
  }
};

TEST_F(TokenCommand, TheServerKnowsTheTokensThatItMakes) {
  const std::string alice = Add({"alice"});
  const std::string root = Add({"root", "--role", "admin", "--max-sessions", "3", "--max-bytes",
                                "1000000000000", "--expires-days", "2"});
  const app::TokenFile tokens = Read();
  EXPECT_EQ(tokens.size(), 2u);
  const auto user = Check(tokens, alice);
  ASSERT_TRUE(user);
  EXPECT_EQ(user->owner, "alice");
  EXPECT_EQ(user->role, app::Role::kUser);
  EXPECT_EQ(user->limits, OwnerLimits{});
  const auto admin = Check(tokens, root);
  ASSERT_TRUE(admin);
  EXPECT_EQ(admin->role, app::Role::kAdmin);
  EXPECT_EQ(admin->limits.max_sessions, 3u);
  EXPECT_EQ(admin->limits.max_bytes, 1'000'000'000'000u);
  const auto now = std::chrono::system_clock::now();
  EXPECT_TRUE(tokens.Check(root, now + std::chrono::hours(47)));
  EXPECT_FALSE(tokens.Check(root, now + std::chrono::hours(49)));
}

TEST_F(TokenCommand, GatewaysHaveLimitsOfTheirOwnAndOfTheirUsers) {
  const std::string hub =
      Add({"hub", "--role", "gateway", "--max-sessions", "50", "--user-max-sessions", "5"});
  const auto user = Read().Check(hub, std::chrono::system_clock::now(), "mia");
  ASSERT_TRUE(user) << user.error().message;
  EXPECT_EQ(user->limits.max_sessions, 5u);
  ASSERT_TRUE(user->gateway);
  EXPECT_EQ(user->gateway->limits.max_sessions, 50u);
  const Outcome list = Arapctl({"token", "list", "--file", file()});
  EXPECT_THAT(list.out, HasSubstr("hub gateway never max_sessions=50 user_max_sessions=5"));
  const Outcome wrong =
      Arapctl({"token", "add", "--file", file(), "--owner", "bob", "--user-max-sessions", "5"});
  EXPECT_NE(wrong.code, 0);
  EXPECT_THAT(wrong.err, HasSubstr("--role gateway"));
}

TEST_F(TokenCommand, TheFileKeepsNoSecretAndLetsNobodyIn) {
  const std::string token = Add({"alice"});
  const std::string text = Slurp(file());
  EXPECT_THAT(text, HasSubstr("alice"));
  EXPECT_THAT(text, Not(HasSubstr(token.substr(token.rfind('_') + 1))));
  EXPECT_EQ(std::filesystem::status(file()).permissions(), perms::owner_read | perms::owner_write);
  // What its group could read it still can, and others cannot.
  std::filesystem::permissions(file(), perms::owner_read | perms::group_read | perms::others_read);
  Add({"bob"});
  EXPECT_EQ(std::filesystem::status(file()).permissions(), perms::owner_read | perms::group_read);
  EXPECT_EQ(Read().size(), 2u);
}

TEST_F(TokenCommand, ListsAndRevokes) {
  const std::string alice = Add({"alice"}), bob = Add({"bob"}), again = Add({"bob"});
  const std::string id(app::TokenFile::IdOf(alice));
  const Outcome list = Arapctl({"token", "list", "--file", file()});
  EXPECT_EQ(list.code, 0);
  EXPECT_THAT(list.out, HasSubstr(id + " alice user never"));
  EXPECT_EQ(std::count(list.out.begin(), list.out.end(), '\n'), 3);
  EXPECT_EQ(Arapctl({"token", "revoke", "--file", file(), "--id", id}).code, 0);
  EXPECT_FALSE(Check(Read(), alice));
  EXPECT_TRUE(Check(Read(), bob));
  EXPECT_EQ(Arapctl({"token", "revoke", "--file", file(), "--id", id}).code, 4);
  EXPECT_EQ(Arapctl({"token", "revoke", "--file", file(), "--owner", "bob"}).code, 0);
  EXPECT_EQ(Read().size(), 0u);
}

TEST_F(TokenCommand, ProcessesThatMeetLoseNothing) {
  std::vector<std::string> old;
  for (int i = 0; i < 5; ++i) {
    old.emplace_back(app::TokenFile::IdOf(Add({"old" + std::to_string(i)})));
  }
  constexpr std::size_t kMany = 20;
  std::vector<std::string> fresh(kMany);
  std::vector<std::future<void>> processes;
  for (std::size_t i = 0; i < kMany; ++i) {
    processes.push_back(
        std::async(std::launch::async, [&, i] { fresh[i] = Add({"owner" + std::to_string(i)}); }));
    if (i % 4 != 0) continue;
    processes.push_back(std::async(std::launch::async, [this, id = old[i / 4]] {
      EXPECT_EQ(Arapctl({"token", "revoke", "--file", file(), "--id", id}).code, 0);
    }));
  }
  // Arapctl ends each of them within its own limit.
  for (std::future<void>& process : processes) process.get();
  const app::TokenFile tokens = Read();
  EXPECT_EQ(tokens.size(), kMany) << "none is lost, and none that was revoked is back";
  for (const std::string& token : fresh) EXPECT_TRUE(Check(tokens, token));
}

TEST_F(TokenCommand, ExpiriesOfOthersStayAsTheyAre) {
  const std::string alice = Add({"alice", "--expires-days", "2"});
  std::string text = Slurp(file());
  const std::size_t end = text.find("Z\"");
  ASSERT_NE(end, std::string::npos);
  const std::size_t begin = text.rfind('"', end);
  text.replace(begin, end + 2 - begin, "\"9999-12-31T23:59:59Z\"");
  Put("tokens.json", text);
  Add({"bob"});
  EXPECT_THAT(Slurp(file()), HasSubstr("\"9999-12-31T23:59:59Z\""));
  EXPECT_EQ(Arapctl({"token", "revoke", "--file", file(), "--owner", "bob"}).code, 0);
  EXPECT_THAT(Arapctl({"token", "list", "--file", file()}).out,
              HasSubstr(" alice user 9999-12-31T23:59:59Z\n"));
  EXPECT_TRUE(Check(Read(), alice));
}

TEST_F(TokenCommand, DamagedFilesAreListedAndRepaired) {
  const std::string alice = Add({"alice"});
  std::string text = Slurp(file());
  const std::string good = text.substr(2, text.rfind("\n]") - 2);
  // Numbers and fields that the server does not know stay as well.
  const std::string king = R"(  {
    "id": "k1",
    "role": "king",
    "owner": "bob",
    "note": [
      1.5
    ]
  })";
  const std::string odd = "  {\n    \"id\": \"x\\u001b\"\n  }";
  const auto put = [&](const std::string& entries) {
    return Put("tokens.json", "[\n" + entries + "\n]\n");
  };
  put(good + ",\n" + king + ",\n" + odd + ",\n  7");
  const Outcome list = Arapctl({"token", "list", "--file", file()});
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_THAT(list.out, HasSubstr(" alice user never\n"));
  EXPECT_THAT(list.out, HasSubstr("\nk1 bob damaged: Token file " + file() + ", entry 1: "));
  EXPECT_THAT(list.out, HasSubstr(", entry 3: it is not an object.\n"));
  EXPECT_THAT(list.out, Not(HasSubstr("\x1b")));
  EXPECT_EQ(std::count(list.out.begin(), list.out.end(), '\n'), 4);
  // Empty arguments match no entry, also none without an id or an owner.
  text = Slurp(file());
  for (const char* which : {"--id", "--owner"}) {
    EXPECT_EQ(Arapctl({"token", "revoke", "--file", file(), which, ""}).code, 4);
  }
  EXPECT_EQ(Arapctl({"token", "add", "--file", file(), "--owner", "a"}).code, 3);
  EXPECT_EQ(Slurp(file()), text);

  put(good + ",\n" + king + ",\n" + odd);
  const Outcome first = Arapctl({"token", "revoke", "--file", file(), "--id", "x\x1b"});
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("1 token revoked\n"));
  EXPECT_THAT(first.err, HasSubstr(", entry 1: "));
  EXPECT_THAT(first.err, HasSubstr("keeps its old tokens"));
  EXPECT_EQ(Slurp(file()), "[\n" + good + ",\n" + king + "\n]\n");
  const Outcome last = Arapctl({"token", "revoke", "--file", file(), "--owner", "bob"});
  EXPECT_EQ(last.err, "arapctl: 1 token revoked\n");
  EXPECT_EQ(Slurp(file()), "[\n" + good + "\n]\n");
  EXPECT_TRUE(Check(Read(), alice));
}

TEST_F(TokenCommand, WrongCommandLinesAndFiles) {
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"token"},
           {"token", "add", "--file", file()},
           {"token", "add", "--owner", "a"},
           {"token", "add", "--file", file(), "--owner", "a/b"},
           {"token", "add", "--file", file(), "--owner", "anonymous"},
           {"token", "add", "--file", file(), "--owner", "a", "--role", "king"},
           {"token", "add", "--file", file(), "--owner", "a", "--expires-days", "0"},
           {"token", "add", "--file", file(), "--owner", "a", "--max-sessions", "-1"},
           {"token", "revoke", "--file", file()},
           {"info", "--spawn", "--tls"},
           {"info", "--spawn", "--token-file", file()}}) {
    EXPECT_EQ(Arapctl(wrong).code, 2) << testing::PrintToString(wrong);
  }
  EXPECT_FALSE(std::filesystem::exists(file()));
  EXPECT_EQ(Arapctl({"token", "list", "--file", file()}).code, 4);
  for (const char* bad : {"{}", "[1]", R"([{"id": 3}])", R"([{"id": "a", "note": "x"}])"}) {
    Put("tokens.json", bad);
    const Outcome outcome = Arapctl({"token", "add", "--file", file(), "--owner", "a"});
    EXPECT_EQ(outcome.code, 3) << bad;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(Slurp(file()), bad);
  }
}

// A server that wants tokens, on a socket.
class TokenFlags : public TokenCommand {
 protected:
  void Start() {
    host::HostOptions options;
    address_ = "unix:" + Path("arapd.sock");
    options.listen = {address_};
    options.credentials.token_file = file();
    auto host = host::Host::Start(options);
    ASSERT_TRUE(host) << host.error().message;
    host_ = *std::move(host);
  }
  Outcome Load(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"load", "--streams", "1", "--seconds", "0.1",   "--vertices",
                                       "16",   "--handles", "2", "--server",  address_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Arapctl(arguments);
  }

 private:
  std::string address_;
  std::unique_ptr<host::Host> host_;
};

TEST_F(TokenFlags, TokensComeFromAFileOrTheEnvironment) {
  const std::string token = Add({"alice"});
  Start();
  const Outcome nobody = Load({});
  EXPECT_EQ(nobody.code, 1);
  const std::string token_file = Put("alice.token", token + "\n");
  const Outcome with_file = Load({"--token-file", token_file, "--connections", "2"});
  EXPECT_EQ(with_file.code, 0) << with_file.err;
  setenv("ARAPCTL_TOKEN", token.c_str(), 1);
  const Outcome with_variable = Load({});
  // Not for a private server, which takes none.
  const Outcome spawned = Arapctl({"info", "--spawn"});
  unsetenv("ARAPCTL_TOKEN");
  EXPECT_EQ(with_variable.code, 0) << with_variable.err;
  EXPECT_EQ(spawned.code, 0) << spawned.err;
  const Outcome missing = Load({"--token-file", Path("none")});
  EXPECT_EQ(missing.code, 4);
  EXPECT_THAT(missing.err, HasSubstr("none"));
}

TEST_F(TokenFlags, RefusalSaysWhatToDo) {
  Add({"alice"});
  Start();
  const std::string surface = Put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome outcome = Arapctl(
      {"flatten", surface, "--out", Path("b.obj"), "--server", "unix:" + Path("arapd.sock")});
  EXPECT_EQ(outcome.code, 5);
  EXPECT_THAT(outcome.err, HasSubstr("UNAUTHENTICATED"));
  EXPECT_THAT(outcome.err, HasSubstr("--token-file"));
}

}  // namespace
}  // namespace arap::cli
