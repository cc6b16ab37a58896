// What ends a stream, and what it leaves.
#include <chrono>

#include "tests/support/bounded.h"
#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

TEST_F(StreamTest, DeletedSessionEndsItsStreams) {
  DeformStream idle(deformation());
  idle.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::DeleteSessionRequest request;
  request.set_session_id("s");
  v1::DeleteSessionResponse response;
  ASSERT_TRUE(Call(&Deformation::DeleteSession, request, &response).ok());
  EXPECT_FALSE(idle.Read().has_value());
  ExpectError(idle.Finish(), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(StreamTest, DeletedSessionLetsTheFrameInWorkOut) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  PoolGate gate(host().engine().interactive);
  stream.Update(1, Moved(1));
  stream.Update(2, Moved(2));
  stream.Ping(1);
  ASSERT_TRUE(host().engine().sessions.Delete(app::kNobody, "s"));
  gate.Open();
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  EXPECT_FALSE(stream.Read().has_value());
  ExpectError(stream.Finish(), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(StreamTest, UpdatesExtendTheSessionAndExpiryEndsTheStream) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  clock().Advance(std::chrono::minutes(40));
  stream.Update(1, Moved(1));
  stream.ReadShape();
  clock().Advance(std::chrono::minutes(40));
  stream.Update(2, Moved(2));
  stream.ReadShape();
  clock().Advance(std::chrono::minutes(61));
  stream.Update(3, Moved(3));
  EXPECT_FALSE(stream.Read().has_value());
  ExpectError(stream.Finish(), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(StreamTest, CancelledStreamIsForgotten) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  EXPECT_EQ(host().engine().streams.count(), 1u);
  {
    PoolGate gate(host().engine().interactive);
    stream.Update(1, Moved(1));
    stream.Ping(1);
    stream.Cancel();
  }
  EXPECT_EQ(stream.Finish().error_code(), grpc::CANCELLED);
  ASSERT_TRUE(
      testing::Await("the stream is gone", [&] { return host().engine().streams.count() == 0; }));
  EXPECT_TRUE(Deform("s", "h", Moved(0)).ok());
}

TEST_F(WireTest, OldConnectionsAskTheirStreamsToMove) {
  options().connections.most_age = std::chrono::seconds(100);
  SetUpCorners();
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  clock().Advance(std::chrono::seconds(112));
  EXPECT_FALSE(stream.Read().has_value());
  const WireError moved = ExpectError(stream.Finish(), grpc::UNAVAILABLE, "DRAINING");
  EXPECT_EQ(moved.metadata.at("resume"), "open_again");
}

}  // namespace
}  // namespace arap::wire
