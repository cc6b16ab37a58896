// Whom a server takes its callers for: a service that answers with who called it, on real wires.
#include "server/rpc/caller_of.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <arap/v1/server_service.grpc.pb.h>
#include <grpcpp/grpcpp.h>

#include "proto/convert/status.h"
#include "server/host/credentials.h"
#include "tests/support/fake_clock.h"
#include "tests/system/wire/authority.h"
#include "tests/system/wire/token_fixture.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

// Answers "owner role max_sessions" in the place of the version.
class WhoAmI final : public v1::ServerService::CallbackService {
 public:
  explicit WhoAmI(const rpc::Identity& identity) : identity_(identity) {}

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* /*request*/,
                                          v1::GetServerInfoResponse* response) override {
    const auto caller = rpc::CallerOf(*context, identity_);
    if (caller) {
      response->set_version(caller->owner +
                            (caller->role == app::Role::kAdmin ? " admin " : " user ") +
                            std::to_string(caller->limits.max_sessions));
    }
    auto* const reactor = context->DefaultReactor();
    reactor->Finish(caller ? grpc::Status::OK : convert::ToGrpcStatus(caller.error()));
    return reactor;
  }

 private:
  const rpc::Identity& identity_;
};

class CallerOfTest : public ::testing::Test {
 protected:
  CallerOfTest() { identity_.limits.max_sessions = 7; }

  void TakeTokens(const std::vector<std::string>& entries) {
    folder_.PutTokens(entries);
    auto tokens = app::Tokens::Open(folder_.tokens(), identity_.limits, clock_);
    ASSERT_TRUE(tokens) << tokens.error().message;
    identity_.tokens = *tokens;
  }

  void Start() {
    auto credentials = host::TcpCredentials(tls_);
    ASSERT_TRUE(credentials) << credentials.error().message;
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", *credentials, &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(port, 0);
    address_ = "127.0.0.1:" + std::to_string(port);
  }

  void ServeTls(const Authority& authority, const Authority* clients = nullptr) {
    const Credential own = authority.Issue("server");
    tls_.certificate = folder_.Put("server.pem", own.certificate);
    tls_.key = folder_.Put("server.key", own.key);
    if (clients != nullptr) tls_.client_ca = folder_.Put("clients.pem", clients->certificate());
  }

  // Who we are when we come like this, or how we are refused.
  using Prepare = std::function<void(grpc::ClientContext&)>;
  grpc::Status Ask(const Prepare& prepare = {}) {
    grpc::ChannelArguments apart;
    apart.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto stub =
        v1::ServerService::NewStub(grpc::CreateCustomChannel(address_, client_, apart));
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(1));
    if (prepare) prepare(context);
    v1::GetServerInfoResponse response;
    const grpc::Status status = stub->GetServerInfo(&context, {}, &response);
    who_ = status.ok() ? response.version() : "";
    return status;
  }
  std::string Who(const Prepare& prepare = {}) {
    const grpc::Status status = Ask(prepare);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return who_;
  }
  static Prepare With(const std::string& value) {
    return [value](grpc::ClientContext& context) { context.AddMetadata("authorization", value); };
  }
  void ExpectRefused(const Prepare& prepare) {
    ExpectError(Ask(prepare), grpc::UNAUTHENTICATED, "UNAUTHENTICATED");
  }

  const SecretFolder folder_;
  runtime::FakeClock clock_;
  rpc::Identity identity_;
  host::TlsOptions tls_;
  std::shared_ptr<grpc::ChannelCredentials> client_ = grpc::InsecureChannelCredentials();

 private:
  WhoAmI service_{identity_};
  std::unique_ptr<grpc::Server> server_;
  std::string address_, who_;
};

TEST_F(CallerOfTest, WithoutIdentityEverybodyIsNobody) {
  Start();
  EXPECT_EQ(Who(), "anonymous user 7");
  // A token that nobody can judge does not pass for none.
  ExpectRefused(With("Bearer " + TestToken('a', "alice").Text()));
}

TEST_F(CallerOfTest, TokensSayWhoCallsWhatTheyMayAndHaveTheirLimits) {
  const TestToken alice('a', "alice"), root('b', "root", "admin");
  TakeTokens({alice.Entry(R"("limits": {"max_sessions": 3})"), root.Entry()});
  Start();
  EXPECT_EQ(Who(With("Bearer " + alice.Text())), "alice user 3");
  EXPECT_EQ(Who(With("bEARER " + root.Text())), "root admin 7");
  EXPECT_EQ(Who(), "anonymous user 7");
  // The session header is a hint for balancers and nothing else.
  EXPECT_EQ(Who([](grpc::ClientContext& context) { context.AddMetadata("x-session-id", "alice"); }),
            "anonymous user 7");
  identity_.demanded = true;
  ExpectRefused({});
}

TEST_F(CallerOfTest, RefusesEveryOtherHeader) {
  const TestToken alice('a', "alice"), stranger('c', "alice");
  TakeTokens({alice.Entry(R"("expires": "2023-11-14T22:13:30Z")")});
  Start();
  std::string wrong = alice.Text();
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& header :
       {"Bearer " + wrong, "Bearer " + stranger.Text(), std::string("Bearer "),
        std::string("Bearer"), std::string(), std::string("Basic YTpi"), alice.Text(),
        "Bearer  " + alice.Text(), "Bearer " + alice.Text() + "0", "Bearer" + alice.Text()}) {
    ExpectRefused(With(header));
  }
  ExpectRefused([&](grpc::ClientContext& context) {
    With("Bearer " + alice.Text())(context);
    With("Bearer " + alice.Text())(context);
  });
  EXPECT_EQ(Who(With("Bearer " + alice.Text())), "alice user 7");
  clock_.Advance(std::chrono::seconds(10));
  ExpectRefused(With("Bearer " + alice.Text()));
}

TEST_F(CallerOfTest, TlsServesThoseWhoTrustItsAuthority) {
  const Authority authority("ours"), other("other");
  ServeTls(authority);
  Start();
  EXPECT_EQ(Ask().error_code(), grpc::UNAVAILABLE);  // plaintext
  client_ = grpc::SslCredentials({other.certificate(), "", ""});
  EXPECT_EQ(Ask().error_code(), grpc::UNAVAILABLE);
  client_ = grpc::SslCredentials({authority.certificate(), "", ""});
  EXPECT_EQ(Who(), "anonymous user 7");
}

TEST_F(CallerOfTest, ClientCertificatesNameOwners) {
  const Authority authority("ours"), clients("clients"), other("other");
  const TestToken alice('a', "alice");
  ServeTls(authority, &clients);
  TakeTokens({alice.Entry()});
  identity_.demanded = true;
  Start();
  const auto with = [&](const Credential& own) {
    return grpc::SslCredentials({authority.certificate(), own.key, own.certificate});
  };
  client_ = with(clients.Issue("bob"));
  EXPECT_EQ(Who(), "bob user 7");
  // The token is the finer statement, and one that does not hold is not excused.
  EXPECT_EQ(Who(With("Bearer " + alice.Text())), "alice user 7");
  ExpectRefused(With("Bearer " + TestToken('c', "bob").Text()));
  client_ = with(clients.Issue("not a name"));
  ExpectRefused({});
  client_ = with(clients.Issue("anonymous"));
  ExpectRefused({});
  client_ = with(other.Issue("bob"));
  EXPECT_EQ(Ask().error_code(), grpc::UNAVAILABLE);
  // Optional here: without one it is the token that counts.
  client_ = grpc::SslCredentials({authority.certificate(), "", ""});
  ExpectRefused({});
  EXPECT_EQ(Who(With("Bearer " + alice.Text())), "alice user 7");
}

TEST_F(CallerOfTest, DemandedClientCertificatesAreDemandedInTheHandshake) {
  const Authority authority("ours"), clients("clients");
  ServeTls(authority, &clients);
  tls_.require_client_certificate = true;
  Start();
  client_ = grpc::SslCredentials({authority.certificate(), "", ""});
  EXPECT_EQ(Ask().error_code(), grpc::UNAVAILABLE);
  const Credential own = clients.Issue("bob");
  client_ = grpc::SslCredentials({authority.certificate(), own.key, own.certificate});
  EXPECT_EQ(Who(), "bob user 7");
}

TEST_F(CallerOfTest, BadTlsFilesAreFaultsThatNameThem) {
  const Authority authority("ours");
  ServeTls(authority);
  EXPECT_TRUE(host::CheckTls(tls_));
  const auto expect = [](const host::TlsOptions& tls, const char* field, const std::string& file) {
    const auto checked = host::TcpCredentials(tls);
    ASSERT_FALSE(checked) << field;
    EXPECT_EQ(checked.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(checked.error().field, field);
    EXPECT_NE(checked.error().message.find(file), std::string::npos) << checked.error().message;
  };
  const std::string none = folder_.Path("none.pem"), empty = folder_.Put("empty.pem", "");
  const std::string other = folder_.Put("other.key", authority.Issue("other").key);
  expect({"", tls_.key, ""}, "tls_cert", "");
  expect({tls_.certificate, "", ""}, "tls_key", "");
  expect({"", "", tls_.certificate}, "tls_cert", "");
  expect({none, tls_.key, ""}, "tls_cert", none);
  expect({empty, tls_.key, ""}, "tls_cert", empty);
  expect({tls_.certificate, none, ""}, "tls_key", none);
  expect({tls_.certificate, tls_.certificate, ""}, "tls_key", tls_.certificate);
  expect({tls_.certificate, other, ""}, "tls_key", other);
  expect({tls_.certificate, tls_.key, none}, "tls_client_ca", none);
  expect({tls_.certificate, tls_.key, empty}, "tls_client_ca", empty);
  expect({tls_.certificate, tls_.key, "", true}, "tls_client_ca", "");
}

}  // namespace
}  // namespace arap::wire
