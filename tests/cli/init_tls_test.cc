// arapctl init-tls: a server takes what it makes, and clients come in by it alone.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/token/authority.h"
#include "server/host/host.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using std::filesystem::perms;
using testing::HasSubstr;

class InitTls : public FolderTest {
 protected:
  std::string file(const std::string& name) const { return Path("tls/" + name); }
  perms ModeOf(const std::string& name) const {
    return std::filesystem::status(file(name)).permissions();
  }
  // A server with the files, on a free port of this machine.
  void Start(bool client_certificates) {
    host::HostOptions options;
    options.listen = {"127.0.0.1:0"};
    options.credentials.tls.certificate = file("server.crt");
    options.credentials.tls.key = file("server.key");
    if (client_certificates) {
      options.credentials.tls.client_ca = file("ca.crt");
      options.credentials.tls.require_client_certificate = true;
    }
    host_.reset();
    auto host = host::Host::Start(options);
    ASSERT_TRUE(host) << host.error().message;
    host_ = *std::move(host);
    const std::string address = host_->addresses().front();
    port_ = address.substr(address.rfind(':'));
  }
  Outcome Ask(const std::string& host, std::vector<std::string> more) const {
    std::vector<std::string> words{"session", "create", "s", "--server", host + port_};
    if (more.empty()) more = {"--tls-ca", file("ca.crt")};
    words.insert(words.end(), more.begin(), more.end());
    return Arapctl(words);
  }
  std::vector<std::string> As(const std::string& owner) const {
    return {"--tls-ca",           file("ca.crt"), "--tls-cert",
            file(owner + ".crt"), "--tls-key",    file(owner + ".key")};
  }
  host::Host& host() { return *host_; }

 private:
  std::string port_;
  std::unique_ptr<host::Host> host_;
};

TEST_F(InitTls, AServerTakesThemAndClientsComeInByThem) {
  const Outcome made = Arapctl({"init-tls", Path("tls"), "--client", "alice", "--client", "bob",
                                "--client", "alice", "--json"});
  ASSERT_EQ(made.code, 0) << made.err;
  const auto json = nlohmann::json::parse(made.out);
  EXPECT_EQ(json["files"].size(), 8u);
  EXPECT_EQ(json["owners"], (std::vector<std::string>{"alice", "bob"}));
  for (const char* name : {"ca", "server", "alice", "bob"}) {
    EXPECT_EQ(ModeOf(std::string(name) + ".key"), perms(0600)) << name;
    EXPECT_EQ(ModeOf(std::string(name) + ".crt"), perms(0644)) << name;
  }
  EXPECT_EQ(ModeOf(""), perms(0700));

  ASSERT_NO_FATAL_FAILURE(Start(false));
  EXPECT_EQ(Ask("localhost", {}).code, 0);
  EXPECT_EQ(Ask("127.0.0.1", {"--tls-ca", file("alice.crt")}).code, 6) << "who did not issue it";
  EXPECT_EQ(Ask("127.0.0.1", {"--tls-ca", file("ca.crt"), "--tls-server-name", "other"}).code, 6);

  ASSERT_NO_FATAL_FAILURE(Start(true));
  EXPECT_EQ(Ask("127.0.0.1", {}).code, 6) << "without a certificate";
  const Outcome alice = Ask("127.0.0.1", As("alice"));
  EXPECT_EQ(alice.code, 0) << alice.err;
  const Outcome bob = Ask("localhost", As("bob"));
  EXPECT_EQ(bob.code, 0) << "a session of his own by that name: " << bob.err;
  const auto owners = host().engine().stores.specs->Owners();
  ASSERT_TRUE(owners);
  EXPECT_EQ(*owners, (std::vector<std::string>{"alice", "bob"}));
  // A client's is no server's.
  EXPECT_EQ(Ask("localhost", {"--tls-ca", file("ca.crt"), "--tls-cert", file("server.crt"),
                              "--tls-key", file("server.key")})
                .code,
            6);
}

TEST_F(InitTls, TheAnswerSaysWhatToDo) {
  const Outcome made = Arapctl({"init-tls", Path("tls/"), "--host", "arapd.example.org", "--host",
                                "fd00::7", "--days", "2"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("0600 " + file("ca.key") + "\n"));
  EXPECT_THAT(made.out, HasSubstr("arapd --tls-cert " + file("server.crt")));
  EXPECT_THAT(made.out, HasSubstr("--tls-client-ca " + file("ca.crt") + " --require-client-cert"));
  EXPECT_THAT(made.out, HasSubstr("--tls-cert " + file("client.crt")));
  ASSERT_NO_FATAL_FAILURE(Start(true));
  auto words = As("client");
  words.insert(words.end(), {"--tls-server-name", "arapd.example.org"});
  const Outcome asked = Ask("127.0.0.1", words);
  EXPECT_EQ(asked.code, 0) << asked.err;
}

TEST_F(InitTls, NothingIsReplacedAndNothingHalfMade) {
  ASSERT_EQ(Arapctl({"init-tls", Path("tls")}).code, 0);
  const std::string before = Slurp(file("ca.key"));
  const Outcome again = Arapctl({"init-tls", Path("tls")});
  EXPECT_EQ(again.code, 3);
  EXPECT_THAT(again.err, HasSubstr("there already"));
  EXPECT_EQ(Slurp(file("ca.key")), before);
  // One file of another command is enough, and no other appears beside it.
  std::filesystem::create_directory(Path("half"));
  Put("half/server.key", "mine");
  EXPECT_EQ(Arapctl({"init-tls", Path("half")}).code, 3);
  EXPECT_EQ(Slurp(Path("half/server.key")), "mine");
  EXPECT_FALSE(std::filesystem::exists(Path("half/ca.key")));
  EXPECT_NE(Arapctl({"init-tls", Put("file", "") + "/tls"}).code, 0);
}

TEST_F(InitTls, WrongCommandLinesMakeNothing) {
  const std::string dir = Path("tls");
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"init-tls"},
                                             {"init-tls", dir, "--host", "a b"},
                                             {"init-tls", dir, "--host", "a,DNS:b"},
                                             {"init-tls", dir, "--host", "300.1.1.1"},
                                             {"init-tls", dir, "--host", ""},
                                             {"init-tls", dir, "--client", "anonymous"},
                                             {"init-tls", dir, "--client", "ca"},
                                             {"init-tls", dir, "--client", "../up"},
                                             {"init-tls", dir, "--client", std::string(65, 'a')},
                                             {"init-tls", dir, "--days", "0"}}) {
    EXPECT_EQ(Arapctl(wrong).code, 2) << testing::PrintToString(wrong);
  }
  EXPECT_FALSE(std::filesystem::exists(dir));
}

TEST(HostNames, AreWhatCertificatesHave) {
  for (const char* good : {"a", "a-b.c9", "*.example.org", "xn--bcher-kva.example"}) {
    EXPECT_TRUE(IsHostName(good)) << good;
  }
  for (const char* bad : {"", ".", "a.", ".a", "-a", "a-", "a..b", "*", "a*.b", "a_b", "1.2.3.4"}) {
    EXPECT_FALSE(IsHostName(bad)) << bad;
  }
  EXPECT_TRUE(IsAddress("::1"));
  EXPECT_FALSE(IsAddress("[::1]"));
}

}  // namespace
}  // namespace arap::cli
