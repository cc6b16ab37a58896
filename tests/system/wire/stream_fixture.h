// Fixture for streams: a square with the handles "a", "b" and "c" in corners.
#pragma once

#include <string>
#include <vector>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {

class StreamTest : public WireTest {
 protected:
  void SetUp() override {
    options().lanes = {1, 1};
    options().limits.max_queued_jobs = 16;
    SetUpCorners();
  }

  static std::vector<v1::HandleTarget> Moved(double dx) {
    return {TargetAt("a", dx, 0), TargetAt("b", 4 + dx, 0), TargetAt("c", dx, 4)};
  }

  // The status of a stream that is sent just this message.
  grpc::Status Only(const v1::StreamDeformRequest& request) {
    DeformStream stream(deformation());
    stream.Send(request);
    EXPECT_FALSE(stream.Read().has_value());
    return stream.Finish();
  }

  // The shape that answers update `last`, of updates 1, 2, 3…: each must be answered or counted as
  // replaced, in order. How many are answered depends on when the server's writes end.
  static v1::Shape ReadUntil(DeformStream& stream, std::uint64_t last) {
    v1::Shape shape;
    std::uint64_t accounted = 0;
    do {
      const auto answer = stream.Read();
      if (!answer || !answer->has_shape()) {
        ADD_FAILURE() << "no shape after " << accounted;
        return shape;
      }
      shape = answer->shape();
      accounted += shape.replaced() + 1;
      EXPECT_EQ(shape.sequence(), accounted);
    } while (shape.sequence() < last);
    EXPECT_EQ(shape.sequence(), last);
    return shape;
  }

  static v1::StreamDeformRequest Edit(std::uint64_t sequence,
                                      const std::vector<std::string>& remove,
                                      const std::vector<v1::Handle>& add) {
    v1::StreamDeformRequest request;
    request.mutable_edit()->set_sequence(sequence);
    request.mutable_edit()->mutable_remove()->Assign(remove.begin(), remove.end());
    request.mutable_edit()->mutable_add()->Assign(add.begin(), add.end());
    return request;
  }
};

}  // namespace arap::wire
