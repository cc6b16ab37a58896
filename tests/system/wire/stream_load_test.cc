// Streams on a server that is full.
#include <future>

#include "tests/support/bounded.h"
#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

TEST_F(StreamTest, FullQueueIsAnsweredInTheStream) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::Handle wide = VertexHandle("w", 12);
  wide.set_area_radius(1.1);
  {
    PoolGate gate(host().engine().jobs);
    while (host().engine().jobs.TryPost([] {}, {app::kNobody})) {
    }
    stream.Send(Edit(1, {}, {wide}));
    const v1::UpdateError error = stream.ReadError();
    EXPECT_EQ(error.sequence(), 1u);
    ExpectError(error.status(), grpc::RESOURCE_EXHAUSTED, "OVERLOADED");
  }
  ASSERT_TRUE(
      testing::Await("the lane is empty", [&] { return host().engine().jobs.waiting() == 0; }));
  stream.Send(Edit(2, {}, {wide}));
  EXPECT_EQ(stream.ReadShape().sequence(), 2u);
}

TEST_F(StreamTest, FramesGoBeforeTheCallsOfOthers) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  std::promise<void> go;
  const auto call = [went = go.get_future().share()] {
    EXPECT_EQ(went.wait_for(testing::kLongest), std::future_status::ready) << "the test goes on";
  };
  {
    PoolGate gate(host().engine().interactive);
    // Calls that are expected to take 20 ms, as those of others are: turns go by what work takes.
    while (host().engine().interactive.TryPost(call, {"others", 0, 0.02})) {
    }
    const std::size_t waiting = host().engine().interactive.waiting();
    stream.Update(1, Moved(1));
    ASSERT_TRUE(testing::Await("the update waits",
                               [&] { return host().engine().interactive.waiting() > waiting; }));
  }
  EXPECT_EQ(stream.ReadShape().sequence(), 1u) << "the queue is full, and no call has ended yet";
  go.set_value();
}

TEST_F(StreamTest, SlowReaderCostsOneFrameAndGetsTheNewest) {
  // Large shapes fill the connection's window; more updates than fit are then replaced, not stored.
  ASSERT_TRUE(Register("s", "large", Grid(200, 200)).ok());
  ASSERT_TRUE(Compile("s", "large", "l", {VertexHandle("a", 0)}).ok());
  DeformStream stream(deformation());
  stream.Opened("s", "l", v1::DELIVERY_LATEST);
  constexpr std::uint64_t kUpdates = 40;
  for (std::uint64_t i = 1; i <= kUpdates; ++i) {
    stream.Update(i, {TargetAt("a", static_cast<double>(i), 0)});
  }
  stream.HalfClose();
  ReadUntil(stream, kUpdates);
  EXPECT_FALSE(stream.Read().has_value());
  EXPECT_TRUE(stream.Finish().ok());
}

class StreamQuotaTest : public StreamTest {
 protected:
  void SetUp() override {
    options().limits.max_streams = 1;
    StreamTest::SetUp();
  }
};

TEST_F(StreamQuotaTest, OpenStreams) {
  DeformStream first(deformation());
  first.Opened("s", "h", v1::DELIVERY_LATEST);
  DeformStream second(deformation());
  EXPECT_FALSE(second.Read().has_value());
  const auto error = ExpectError(second.Finish(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_streams");
  first.HalfClose();
  EXPECT_FALSE(first.Read().has_value());
  EXPECT_TRUE(first.Finish().ok());
  ASSERT_TRUE(
      testing::Await("the stream is gone", [&] { return host().engine().streams.count() == 0; }));
  DeformStream third(deformation());
  third.Opened("s", "h", v1::DELIVERY_LATEST);
}

}  // namespace
}  // namespace arap::wire
