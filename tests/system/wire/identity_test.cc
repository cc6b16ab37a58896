// Identity and transport of a whole server: streams hear of revoked tokens, certificates change, the
// log keeps secrets.
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "arap/client/client.h"
#include "proto/convert/mesh.h"
#include "tests/support/bounded.h"
#include "tests/system/wire/authority.h"
#include "tests/system/wire/token_fixture.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;
using ::testing::Not;

class IdentityTest : public WireTest {
 protected:
  void TakeTokens() {
    folder_.PutTokens({alice_.Entry(), bob_.Entry()});
    options().credentials.token_file = folder_.tokens();
    options().credentials.refresh = std::chrono::hours(1);
  }
  void ServeTls(const Authority& authority) {
    const Credential own = authority.Issue("server");
    options().credentials.tls.certificate = folder_.Put("server.pem", own.certificate);
    options().credentials.tls.key = folder_.Put("server.key", own.key);
    options().credentials.tls.refresh_seconds = 1;
  }

  std::string address() { return host().addresses().front(); }
  Result<client::Client> Connect(const client::ConnectOptions& with) {
    return client::Client::Connect(address(), with);
  }
  client::Client ConnectAs(const TestToken& token) {
    client::ConnectOptions with;
    with.token = token.Text();
    return Connect(with).value();
  }
  // A session of `client` with the set "set" on a grid.
  static client::Session SetUp(const client::Client& client) {
    auto session = client.CreateSession();
    EXPECT_TRUE(session) << session.error().message;
    const auto grid = convert::FromWire(Grid(2, 2), MeshLimits{});
    EXPECT_TRUE(session->RegisterMesh(grid.value(), {}, "mesh"));
    const std::vector<client::Handle> handles{{"left", client::VertexAnchor{0}},
                                              {"right", client::VertexAnchor{2}}};
    EXPECT_TRUE(session->CompileHandles("set", "mesh", handles));
    return *session;
  }
  static client::DeformStream Open(const client::Session& session) {
    auto stream = session.OpenStream("set", {.heartbeat = {}});
    EXPECT_TRUE(stream) << stream.error().message;
    return *std::move(stream);
  }
  static void ExpectAlive(client::DeformStream& stream) {
    EXPECT_TRUE(stream.Ping(5));
    const auto event = stream.Read();
    ASSERT_TRUE(event) << event.error().message;
    ASSERT_TRUE(event->has_value());
    EXPECT_TRUE(std::holds_alternative<client::Pong>(**event));
  }

  const SecretFolder folder_;
  const TestToken alice_{'a', "alice"};
  const TestToken bob_{'b', "bob"};
};

TEST_F(IdentityTest, ClientWithATokenIsServed) {
  TakeTokens();
  const client::Client client = ConnectAs(alice_);
  client::DeformStream stream = Open(SetUp(client));
  ExpectAlive(stream);
}

TEST_F(IdentityTest, AGatewaysUsersAreOwnersUnderItsLimits) {
  const TestToken hub('c', "hub", "gateway");
  folder_.PutTokens({alice_.Entry(), hub.Entry(R"("limits": {"max_sessions": 3},
                                                  "user_limits": {"max_sessions": 2})")});
  options().credentials.token_file = folder_.tokens();
  const auto as = [&](const std::string& user) {
    client::ConnectOptions with;
    with.token = hub.Text();
    with.user = user;
    return Connect(with).value();
  };
  const auto create = [](const client::Client& client, const char* id) {
    client::SessionOptions named;
    named.id = id;
    return client.CreateSession(named);
  };
  const auto quota = [](const Result<client::Session>& refused) {
    for (const auto& [name, value] : refused.error().details) {
      if (name == "quota") return value;
    }
    return std::string();
  };
  const client::Client mia = as("mia"), ben = as("ben");
  client::DeformStream stream = Open(SetUp(mia));
  ASSERT_TRUE(create(mia, "s"));
  ASSERT_TRUE(create(ben, "s")) << "the same name is another owner's session";
  EXPECT_EQ(ben.ListSessions()->sessions.size(), 1u);
  const auto third = create(mia, "t");
  ASSERT_FALSE(third);
  EXPECT_EQ(quota(third), "max_sessions_per_owner");
  const auto fourth = create(ben, "t");
  ASSERT_FALSE(fourth);
  EXPECT_EQ(quota(fourth), "max_sessions_per_gateway");
  EXPECT_EQ(host().engine().metrics.Text().find("mia"), std::string::npos) << "no label by owner";

  client::ConnectOptions with;
  with.token = alice_.Text();
  with.user = "mia";
  const auto refused = create(Connect(with).value(), "s");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kPermissionDenied);

  // The streams of its users end with the gateway's token.
  ExpectAlive(stream);
  folder_.PutTokens({alice_.Entry()});
  ASSERT_TRUE(host().credentials().Reload());
  const auto end = stream.Read();
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, FaultKind::kUnauthenticated);
}

TEST_F(IdentityTest, SessionsOfOthersAreAsThoughTheyWereNotThere) {
  TakeTokens();
  const client::Client alice = ConnectAs(alice_), bob = ConnectAs(bob_);
  client::SessionOptions named;
  named.id = "same";
  ASSERT_TRUE(alice.CreateSession(named));
  const auto foreign = bob.AttachSession("same").Get();
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().kind, FaultKind::kNotFound);
  EXPECT_EQ(bob.AttachSession("same").Delete().error().kind, FaultKind::kNotFound);
  EXPECT_TRUE(bob.ListSessions()->sessions.empty());
  EXPECT_TRUE(bob.CreateSession(named));
  EXPECT_TRUE(bob.AttachSession("same").Delete());
  EXPECT_TRUE(alice.AttachSession("same").Get());
}

TEST_F(IdentityTest, StreamsUnderARevokedTokenEnd) {
  TakeTokens();
  client::DeformStream alices = Open(SetUp(ConnectAs(alice_)));
  client::DeformStream bobs = Open(SetUp(ConnectAs(bob_)));
  folder_.PutTokens({bob_.Entry()});
  ASSERT_TRUE(host().credentials().Reload());
  const auto event = alices.Read();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kUnauthenticated);
  ExpectAlive(bobs);
  const auto again = ConnectAs(alice_).CreateSession();
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, FaultKind::kUnauthenticated);
  // A file that cannot be used changes nothing.
  folder_.Put("tokens.json", "{");
  EXPECT_FALSE(host().credentials().Reload());
  ExpectAlive(bobs);
}

TEST_F(IdentityTest, TracksUnderARevokedTokenEnd) {
  TakeTokens();
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 8;
  const client::Session session = SetUp(ConnectAs(alice_));
  PoolGate gate(host().engine().jobs);
  Status ended;
  testing::BoundedThread caller("the track", [&] {
    const std::vector<std::string> ids{"left", "right"};
    const std::vector<std::vector<Target>> frames(100, {{{0, 0}}, {{2, 0}}});
    ended = session.DeformTrack("set", ids, frames, {}, [](client::Shape&&) { return true; });
  });
  ASSERT_TRUE(
      testing::Await("the call is open", [&] { return host().engine().streams.count() > 0; }));
  folder_.PutTokens({bob_.Entry()});
  // The track may still be on its way from being counted to being watched; then it is told at once.
  ASSERT_TRUE(host().credentials().Reload());
  gate.Open();
  caller.Join();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, FaultKind::kUnauthenticated);
}

TEST_F(IdentityTest, ChangedTokenFileIsTakenByItself) {
  TakeTokens();
  options().credentials.refresh = std::chrono::milliseconds(5);
  client::DeformStream alices = Open(SetUp(ConnectAs(alice_)));
  folder_.PutTokens({bob_.Entry()});
  const auto event = alices.Read();  // waits for it
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kUnauthenticated);
}

TEST_F(IdentityTest, StreamsEndWhenTheirTokenExpires) {
  TakeTokens();
  folder_.PutTokens({alice_.Entry(R"("expires": "2023-11-14T22:13:30Z")")});
  options().credentials.refresh = std::chrono::milliseconds(5);
  client::DeformStream alices = Open(SetUp(ConnectAs(alice_)));
  ExpectAlive(alices);
  clock().Advance(seconds(10));
  const auto event = alices.Read();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kUnauthenticated);
}

TEST_F(IdentityTest, NewConnectionsSeeNewCertificatesAndOldStreamsGoOn) {
  const Authority before("before"), after("after");
  ServeTls(before);
  client::ConnectOptions old_trust, new_trust;
  old_trust.root_certificates = folder_.Put("before.pem", before.certificate());
  new_trust.root_certificates = folder_.Put("after.pem", after.certificate());
  client::DeformStream stream = Open(SetUp(Connect(old_trust).value()));
  ServeTls(after);  // the server looks again every second
  const auto deadline = std::chrono::steady_clock::now() + seconds(60);
  while (!Connect(new_trust)->WaitReady(std::chrono::milliseconds(200))) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the certificate did not change";
  }
  EXPECT_TRUE(Connect(new_trust)->GetServerInfo());
  EXPECT_FALSE(Connect(old_trust)->GetServerInfo({seconds(10)}));
  ExpectAlive(stream);
}

TEST_F(IdentityTest, ClientLibraryUsesTlsTokenAndCertificate) {
  const Authority authority("ours"), clients("clients");
  ServeTls(authority);
  TakeTokens();
  options().credentials.tls.client_ca = folder_.Put("clients.pem", clients.certificate());
  client::ConnectOptions with;
  with.root_certificates = folder_.Put("ours.pem", authority.certificate());
  const auto nobody = Connect(with)->CreateSession();
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().kind, FaultKind::kUnauthenticated);
  with.token = alice_.Text();
  EXPECT_TRUE(Connect(with)->CreateSession());
  with.token.clear();
  const Credential own = clients.Issue("carol");
  with.certificate = folder_.Put("carol.pem", own.certificate);
  with.key = folder_.Put("carol.key", own.key);
  EXPECT_TRUE(Connect(with)->CreateSession());
  with.server_name = "elsewhere.example.org";
  EXPECT_FALSE(Connect(with)->GetServerInfo({seconds(10)}));
  with.server_name = "localhost";
  EXPECT_TRUE(Connect(with)->GetServerInfo());
  client::ConnectOptions plain;
  plain.token = alice_.Text();
  EXPECT_FALSE(Connect(plain)->GetServerInfo({seconds(10)}));
}

TEST(ConnectOptions, WhatDoesNotGoTogetherIsAFault) {
  const SecretFolder folder;
  const auto fault = [](const std::string& address, const client::ConnectOptions& options) {
    const auto client = client::Client::Connect(address, options);
    if (client) return std::string();
    EXPECT_EQ(client.error().kind, FaultKind::kInvalidOption);
    EXPECT_THAT(client.error().message, Not(HasSubstr("hush")));
    return client.error().field;
  };
  client::ConnectOptions token;
  token.token = "hush";
  for (const char* local : {"unix:/x", "127.0.0.1:1", "localhost:1", "[::1]:1"}) {
    EXPECT_EQ(fault(local, token), "") << local;
  }
  for (const char* away : {"10.0.0.1:1", "example.org:1", "127.example.org:1"}) {
    EXPECT_EQ(fault(away, token), "token") << away;
  }
  token.token_in_plaintext = true;
  EXPECT_EQ(fault("10.0.0.1:1", token), "");
  token.token = "two hush\nlines";
  EXPECT_EQ(fault("unix:/x", token), "token");
  client::ConnectOptions files;
  files.certificate = folder.Put("a.pem", "x");
  EXPECT_EQ(fault("unix:/x", files), "key");
  files.key = folder.Path("none.key");
  EXPECT_EQ(fault("unix:/x", files), "key");
  files = {};
  files.root_certificates = folder.Path("none.pem");
  EXPECT_EQ(fault("unix:/x", files), "root_certificates");
}

TEST_F(IdentityTest, NetworkIsNotServedByMistake) {
  options().listen = {"0.0.0.0:0"};
  const auto plain = host::Host::Start(options());
  ASSERT_FALSE(plain);
  EXPECT_EQ(plain.error().kind, FaultKind::kPermissionDenied);
  ServeTls(Authority("ours"));
  const auto open = host::Host::Start(options());
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().kind, FaultKind::kPermissionDenied);
  TakeTokens();
  EXPECT_TRUE(host::Host::Start(options()));
  options().credentials = {};
  options().credentials.allow_plaintext = true;
  EXPECT_TRUE(host::Host::Start(options()));
}

TEST_F(IdentityTest, TheUserOfACallIsForGatewaysAlone) {
  const TestToken hub('c', "hub", "gateway"), root('d', "root", "admin");
  folder_.PutTokens({alice_.Entry(), hub.Entry(), root.Entry()});
  options().credentials.token_file = folder_.tokens();
  const auto call = [&](const TestToken* token, const std::vector<std::string>& users,
                        const std::string& owner = {}) {
    grpc::ClientContext context;
    SetDeadline(context);
    if (token != nullptr) context.AddMetadata("authorization", "Bearer " + token->Text());
    for (const std::string& user : users) context.AddMetadata("x-arapd-owner", user);
    v1::ListSessionsRequest request;
    request.set_owner(owner);
    v1::ListSessionsResponse response;
    const grpc::Status status = deformation().ListSessions(&context, request, &response);
    return std::pair(status, response.sessions_size());
  };
  ExpectError(call(nullptr, {"mia"}).first, grpc::UNAUTHENTICATED, "UNAUTHENTICATED");
  ExpectError(call(&hub, {"mia", "ben"}).first, grpc::UNAUTHENTICATED, "UNAUTHENTICATED");
  ExpectError(call(&alice_, {"mia"}).first, grpc::PERMISSION_DENIED, "PERMISSION_DENIED");
  ExpectError(call(&root, {"mia"}).first, grpc::PERMISSION_DENIED, "PERMISSION_DENIED");
  ExpectError(call(&hub, {"mia@example.com"}).first, grpc::INVALID_ARGUMENT, "INVALID_NAME");

  client::ConnectOptions with;
  with.token = hub.Text();
  with.user = "mia";
  ASSERT_TRUE(Connect(with)->CreateSession());
  EXPECT_EQ(call(&hub, {"mia"}).second, 1);
  EXPECT_EQ(call(&hub, {}).second, 0) << "not of the gateway itself";
  EXPECT_EQ(call(&root, {}, "hub/mia").second, 1);
  EXPECT_FALSE(call(&hub, {"ben"}, "hub/mia").first.ok());
}

TEST_F(IdentityTest, LogHoldsNoSecret) {
  std::ostringstream text;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text)));
  spdlog::set_level(spdlog::level::trace);
  const Authority authority("ours");
  ServeTls(authority);
  TakeTokens();
  client::ConnectOptions with;
  with.root_certificates = folder_.Put("ours.pem", authority.certificate());
  with.token = alice_.Text();
  client::DeformStream stream = Open(SetUp(Connect(with).value()));
  const TestToken hub('d', "hub", "gateway");
  folder_.PutTokens({alice_.Entry(), hub.Entry()});
  EXPECT_TRUE(host().credentials().Reload());
  with.token = hub.Text();
  with.user = "mia";
  EXPECT_TRUE(Connect(with)->CreateSession());
  with.user.clear();
  const TestToken stranger('c', "mallory");
  with.token = stranger.Text();
  const auto refused = Connect(with)->CreateSession();
  ASSERT_FALSE(refused);
  folder_.PutTokens({bob_.Entry(), bob_.Entry()});
  EXPECT_FALSE(host().credentials().Reload());
  folder_.PutTokens({bob_.Entry()});
  EXPECT_TRUE(host().credentials().Reload());
  EXPECT_FALSE(stream.Read());
  host().Stop(std::chrono::seconds(10));
  spdlog::set_default_logger(before);
  spdlog::set_level(spdlog::level::off);

  const std::string log = text.str() + refused.error().message;
  EXPECT_THAT(log, HasSubstr("rpc=CreateSession owner=alice session="));
  EXPECT_THAT(log, HasSubstr("rpc=CreateSession owner=hub/mia session="));
  EXPECT_THAT(log, HasSubstr("reason=UNAUTHENTICATED"));
  EXPECT_THAT(log, HasSubstr("event=tokens_kept"));
  EXPECT_THAT(log, HasSubstr("event=tokens_reloaded tokens=1"));
  for (const TestToken* token : {&alice_, &bob_, &hub, &stranger}) {
    EXPECT_THAT(log, Not(HasSubstr(token->secret())));
    EXPECT_THAT(log, Not(HasSubstr(token->salt())));
    EXPECT_THAT(log, Not(HasSubstr(token->hash())));
    EXPECT_THAT(log, Not(HasSubstr("arapd_")));
  }
  EXPECT_THAT(log, Not(HasSubstr("PRIVATE KEY")));
}

}  // namespace
}  // namespace arap::wire
