// What ends a stream for good, and what does not.
#include "client/src/stream_call.h"

#include <gmock/gmock.h>

namespace arap::client::internal {
namespace {

TEST(Lost, IsWhatTheServersEndLooksLikeAlsoBehindProxies) {
  using enum grpc::StatusCode;
  EXPECT_TRUE(IsLost({UNAVAILABLE, "Socket closed"}));
  EXPECT_TRUE(IsLost({UNKNOWN, "No status received"}));
  EXPECT_TRUE(IsLost({INTERNAL, "Received RST_STREAM with error code 2"}));
  EXPECT_TRUE(IsLost({CANCELLED, "Received RST_STREAM with error code 8"}));
  EXPECT_FALSE(IsLost({UNKNOWN, "something else"}));
  EXPECT_FALSE(IsLost({INTERNAL, "a bug"}));
  EXPECT_TRUE(IsLost({CANCELLED, "CANCELLED"}));
  EXPECT_FALSE(IsLost({NOT_FOUND, ""}));
  EXPECT_FALSE(IsLost(grpc::Status::OK));
}

TEST(Full, IsWhatMayFindRoomLater) {
  const auto coded = [](const char* code) {
    return Fault(FaultKind::kInternal, "").Detail(std::string(kGrpcCodeDetail), code);
  };
  EXPECT_TRUE(IsFull(coded("RESOURCE_EXHAUSTED")));
  EXPECT_FALSE(IsFull(coded("NOT_FOUND")));
}

}  // namespace
}  // namespace arap::client::internal
