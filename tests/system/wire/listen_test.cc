// Where a server may listen, and with what.
#include "server/host/listen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace arap::host {
namespace {

using testing::HasSubstr;

TEST(Listen, KnowsWhatOnlyThisMachineReaches) {
  for (const char* local : {"unix:/run/arapd.sock", "unix:arapd.sock", "127.0.0.1:50051",
                            "127.9.8.7:0", "[::1]:50051", "localhost:50051"}) {
    EXPECT_TRUE(IsLocal(local)) << local;
  }
  for (const char* open :
       {"0.0.0.0:50051", "[::]:50051", "10.0.0.1:1", "128.0.0.1:1", "[::ffff:127.0.0.1]:1",
        "example.org:1", "localhost.example.org:1", "127.0.0.1.example.org:1", "[::1]x:1", ":1"}) {
    EXPECT_FALSE(IsLocal(open)) << open;
  }
}

TEST(Listen, LocalAddressesNeedNothing) {
  EXPECT_TRUE(CheckExposure({"unix:/run/a", "127.0.0.1:1", "[::1]:2"}, {}));
}

TEST(Listen, PlaintextToTheNetworkIsRefusedUnlessSaidSo) {
  const std::vector<std::string> listen{"127.0.0.1:1", "0.0.0.0:2"};
  Exposure exposure;
  exposure.identity = true;  // tokens would be readable on the way
  exposure.allow_anyone = true;
  const auto refused = CheckExposure(listen, exposure);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kPermissionDenied);
  EXPECT_EQ(refused.error().field, "listen");
  EXPECT_THAT(refused.error().message, HasSubstr("0.0.0.0:2"));
  EXPECT_THAT(refused.error().message, HasSubstr(kAllowPlaintextFlag));
  exposure.allow_plaintext = true;
  EXPECT_TRUE(CheckExposure(listen, exposure));
}

TEST(Listen, NetworkWithoutIdentityIsRefusedUnlessSaidSo) {
  Exposure exposure;
  exposure.tls = true;
  const auto refused = CheckExposure({"[::]:1"}, exposure);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr(kAllowAnyoneFlag));
  exposure.allow_anyone = true;
  EXPECT_TRUE(CheckExposure({"[::]:1"}, exposure));
  exposure.allow_anyone = false;
  exposure.identity = true;
  EXPECT_TRUE(CheckExposure({"[::]:1"}, exposure));
}

}  // namespace
}  // namespace arap::host
