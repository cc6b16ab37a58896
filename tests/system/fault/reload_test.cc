// SIGHUP with another token file: one that cannot be used changes nothing, a good one is in force
// at once. By itself the server would look only every few seconds.
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// A macro of glibc's resolver, and a name that Eigen uses.
#undef _res

#include "arap/client/client.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/server_process.h"
#include "tests/system/wire/token_fixture.h"

namespace arap::fault {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kFailed = "event=reload_failed what=access";
constexpr const char* kDone = "event=reloaded what=access";

class ReloadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.PutTokens({alice_.Entry()});
    ASSERT_TRUE(server_.Start());
  }

  client::Client As(const wire::TestToken& token) const {
    client::ConnectOptions with;
    with.token = token.Text();
    return client::Client::Connect(server_.address(), with).value();
  }
  void ExpectServed(const wire::TestToken& token) const {
    const auto sessions = As(token).ListSessions();
    EXPECT_TRUE(sessions) << sessions.error().message;
  }
  void ExpectRefused(const wire::TestToken& token) const {
    const auto sessions = As(token).ListSessions();
    ASSERT_FALSE(sessions);
    EXPECT_EQ(sessions.error().kind, FaultKind::kUnauthenticated) << sessions.error().message;
  }

  // A stream under the token, in a session of its own.
  client::DeformStream OpenAs(const wire::TestToken& token) const {
    const auto session = As(token).CreateSession().value();
    const client::PlanarMesh square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    EXPECT_TRUE(session.RegisterMesh(square, {}, "m"));
    const std::vector<client::Handle> handles{{"l", client::VertexAnchor{0}}};
    EXPECT_TRUE(session.CompileHandles("h", "m", handles));
    return session.OpenStream("h", {.heartbeat = {}}).value();
  }
  static void ExpectAlive(client::DeformStream& stream) {
    EXPECT_TRUE(stream.Ping(5));
    const auto event = stream.Read();
    ASSERT_TRUE(event && *event) << event.error().message;
    EXPECT_TRUE(std::holds_alternative<client::Pong>(**event));
  }

  std::size_t Count(const std::string& words) const {
    const std::string log = server_.Log();
    std::size_t count = 0;
    for (std::size_t at = 0; (at = log.find(words, at)) != std::string::npos; ++at) ++count;
    return count;
  }
  // Sends SIGHUP, which must end with these words in the log.
  void Hangup(const char* outcome) {
    const std::size_t before = Count(outcome);
    server_.Signal(SIGHUP);
    EXPECT_TRUE(Eventually([&] { return Count(outcome) == before + 1; })) << server_.Log();
  }

  void ExpectLogKeepsSecrets() const {
    const std::string log = server_.Log();
    for (const wire::TestToken* token : {&alice_, &bob_}) {
      EXPECT_THAT(log, Not(HasSubstr(token->secret())));
      EXPECT_THAT(log, Not(HasSubstr(token->salt())));
      EXPECT_THAT(log, Not(HasSubstr(token->hash())));
    }
  }

  const wire::SecretFolder folder_;
  const wire::TestToken alice_{'a', "alice"};
  const wire::TestToken bob_{'b', "bob"};
  ServerProcess server_{{"--token-file", folder_.tokens(), "--log-level", "debug"},
                        "unix:{}/socket"};
};

TEST_F(ReloadTest, AFileThatCannotBeUsedChangesNothing) {
  client::DeformStream stream = OpenAs(alice_);
  // Each of them would let in bob as well, and most would turn alice away.
  const std::string half = "[" + bob_.Entry() + "," + alice_.Entry();
  for (const std::string& text :
       {half, std::string(), "{\"tokens\": " + half + "]}", half + ", {}]",
        "[" + bob_.Entry(R"("role": "king")") + "]", "[" + bob_.Entry(R"("sha256": "0")") + "]",
        half + "," + bob_.Entry() + "]"}) {
    SCOPED_TRACE(text);
    folder_.Put("tokens.json", text);
    Hangup(kFailed);
    ExpectServed(alice_);
    ExpectRefused(bob_);
    ExpectAlive(stream);
  }
  // Good, but others may read it; and none at all.
  folder_.PutTokens({bob_.Entry()});
  std::filesystem::permissions(folder_.tokens(), std::filesystem::perms::others_read,
                               std::filesystem::perm_options::add);
  Hangup(kFailed);
  std::filesystem::remove(folder_.tokens());
  Hangup(kFailed);
  ExpectServed(alice_);
  ExpectRefused(bob_);
  ExpectAlive(stream);
  EXPECT_THAT(server_.Log(), HasSubstr(folder_.tokens())) << "says which file";
  EXPECT_EQ(Count(kDone), 0u);
  ExpectLogKeepsSecrets();
}

TEST_F(ReloadTest, AGoodFileIsInForceAtOnceAlsoAfterABadOne) {
  client::DeformStream stream = OpenAs(alice_);
  ExpectRefused(bob_);
  folder_.Put("tokens.json", "[" + bob_.Entry());
  Hangup(kFailed);
  ExpectRefused(bob_);
  folder_.PutTokens({bob_.Entry()});
  Hangup(kDone);
  ExpectServed(bob_);
  ExpectRefused(alice_);
  const auto end = stream.Read();
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, FaultKind::kUnauthenticated) << end.error().message;
  ExpectLogKeepsSecrets();
}

}  // namespace
}  // namespace arap::fault
