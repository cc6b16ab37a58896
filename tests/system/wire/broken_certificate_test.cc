// Certificate files that cannot be used for a while: the server goes on with those that it had, for
// new connections too.
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "tests/system/wire/authority.h"
#include "tests/system/wire/token_fixture.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

using std::chrono::seconds;

class BrokenCertificateTest : public WireTest {
 protected:
  BrokenCertificateTest() {
    Serve(authority_.Issue("server"));
    options().credentials.tls.refresh_seconds = 1;
    with_.root_certificates = folder_.Put("authority.pem", authority_.certificate());
  }

  void Serve(const Credential& own) {
    options().credentials.tls.certificate = folder_.Put("server.pem", own.certificate);
    options().credentials.tls.key = folder_.Put("server.key", own.key);
  }
  // A connection of its own.
  Result<client::Client> Connect() {
    return client::Client::Connect(host().addresses().front(), with_);
  }
  bool Serves() { return Connect()->GetServerInfo({seconds(30)}).has_value(); }

  const SecretFolder folder_;
  const Authority authority_{"ours"};
  client::ConnectOptions with_;
};

TEST_F(BrokenCertificateTest, WhatCannotBeUsedLeavesThingsAsTheyWere) {
  const client::Client before = Connect().value();
  ASSERT_TRUE(before.GetServerInfo());
  const Credential other = authority_.Issue("server");
  const Credential whole = authority_.Issue("server");
  // Half a key, no certificate, a pair that does not belong together.
  for (const Credential& broken :
       {Credential{whole.certificate, whole.key.substr(0, whole.key.size() / 2)},
        Credential{"", whole.key}, Credential{whole.certificate, other.key}}) {
    Serve(broken);
    EXPECT_FALSE(host().credentials().Reload());
    EXPECT_TRUE(before.GetServerInfo());
    EXPECT_TRUE(Serves());
    Serve(whole);
    EXPECT_TRUE(host().credentials().Reload());
    EXPECT_TRUE(Serves());
  }
}

}  // namespace
}  // namespace arap::wire
