// Which shapes are measured, by single calls, in tracks and in streams, and what the others leave out.
#include <algorithm>
#include <optional>
#include <string>

#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

class MeasureTest : public StreamTest {
 protected:
  // Of the corners pulled apart, unlike a motion: what is measured of it is not 0.
  static std::vector<v1::HandleTarget> Pulled(double by) {
    return {TargetAt("a", -by, 0), TargetAt("b", 4, by), TargetAt("c", 0, 5)};
  }

  static v1::DeformOptions Every(std::optional<std::uint32_t> measure_every) {
    v1::DeformOptions options;
    options.set_include_flipped_ids(true);
    if (measure_every) options.set_measure_every(*measure_every);
    return options;
  }

  v1::Shape One(const v1::DeformOptions& options) {
    v1::DeformRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    for (const auto& target : Pulled(1)) *request.add_targets() = target;
    *request.mutable_options() = options;
    v1::DeformResponse response;
    EXPECT_TRUE(Call(&Deformation::Deform, request, &response).ok());
    return response.shape();
  }

  // 'm' for a shape that is measured, '.' for one that says that it is not and leaves it out.
  static char MarkOf(const v1::Shape& shape) {
    EXPECT_GT(shape.worst_handle_error(), 0);
    EXPECT_FALSE(shape.worst_handle_id().empty());
    const bool told = shape.energy() > 0 && shape.mean_stretch() > 1 && shape.max_stretch() > 1;
    const bool nothing = shape.energy() == 0 && shape.mean_stretch() == 0 &&
                         shape.max_stretch() == 0 && shape.flipped_count() == 0 &&
                         shape.flipped_ids_size() == 0;
    EXPECT_EQ(shape.unmeasured(), nothing);
    EXPECT_EQ(!shape.unmeasured(), told);
    return shape.unmeasured() ? '.' : 'm';
  }

  // Its answer to each of so many updates, read before the next is sent.
  static std::string Drag(DeformStream& stream, std::uint64_t first, std::uint64_t last,
                          std::uint64_t asking = 0) {
    std::string marks;
    for (std::uint64_t i = first; i <= last; ++i) {
      v1::StreamDeformRequest request;
      request.mutable_update()->set_sequence(i);
      if (i == first) {
        for (const auto& target : Pulled(1)) *request.mutable_update()->add_targets() = target;
      }
      request.mutable_update()->set_measure(i == asking);
      stream.Send(request);
      marks += MarkOf(stream.ReadShape());
    }
    return marks;
  }

  static void Open(DeformStream& stream, v1::Delivery delivery, const v1::DeformOptions& options) {
    v1::StreamDeformRequest request;
    request.mutable_open()->set_session_id("s");
    request.mutable_open()->set_handle_set_id("h");
    request.mutable_open()->set_delivery(delivery);
    *request.mutable_open()->mutable_options() = options;
    stream.Send(request);
    const auto opened = stream.Read();
    ASSERT_TRUE(opened && opened->has_opened());
  }
};

TEST_F(MeasureTest, OfASingleShape) {
  const v1::Shape measured = One(Every({}));
  EXPECT_EQ(MarkOf(measured), 'm');
  EXPECT_EQ(MarkOf(One(Every(1))), 'm');
  EXPECT_EQ(MarkOf(One(Every(7))), 'm') << "it is the first";
  const v1::Shape shape = One(Every(0));
  EXPECT_EQ(MarkOf(shape), '.');
  EXPECT_TRUE(std::equal(shape.positions().begin(), shape.positions().end(),
                         measured.positions().begin(), measured.positions().end()));
  EXPECT_EQ(shape.worst_handle_error(), measured.worst_handle_error());
  EXPECT_EQ(shape.worst_handle_id(), measured.worst_handle_id());
}

TEST_F(MeasureTest, OfFramesOfATrack) {
  const std::pair<std::optional<std::uint32_t>, const char*> cases[] = {{std::nullopt, "mmmmmmm"},
                                                                        {1, "mmmmmmm"},
                                                                        {2, "m.m.m.m"},
                                                                        {3, "m..m..m"},
                                                                        {9, "m......"},
                                                                        {0, "......."}};
  for (const auto& [every, expected] : cases) {
    v1::DeformTrackRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    for (const char* id : {"a", "b", "c"}) request.add_handle_ids(id);
    for (int i = 0; i < 7; ++i) {
      v1::TrackFrame& frame = *request.add_frames();
      for (const double value : {-1.0, 0.0, 4.0, 1.0 + i, 0.0, 5.0}) frame.add_positions(value);
    }
    *request.mutable_options() = Every(every);
    grpc::ClientContext context;
    SetDeadline(context);
    auto reader = deformation().DeformTrack(&context, request);
    std::string marks;
    for (v1::DeformTrackResponse response; reader->Read(&response);) {
      marks += MarkOf(response.shape());
    }
    EXPECT_TRUE(reader->Finish().ok());
    EXPECT_EQ(marks, expected);
  }
}

TEST_F(MeasureTest, OfUpdatesOfAStream) {
  const struct {
    std::optional<std::uint32_t> every;
    std::uint64_t asking;
    const char* marks;
  } cases[] = {{std::nullopt, 0, "mmmmmmm"},
               {1, 0, "mmmmmmm"},
               {3, 0, "m..m..m"},
               {3, 2, "mm..m.."},
               {0, 0, "......."},
               {0, 7, "......m"}};
  for (const v1::Delivery delivery : {v1::DELIVERY_LATEST, v1::DELIVERY_EVERY}) {
    for (const auto& [every, asking, marks] : cases) {
      DeformStream stream(deformation());
      Open(stream, delivery, Every(every));
      EXPECT_EQ(Drag(stream, 1, 7, asking), marks);
      stream.HalfClose();
      EXPECT_FALSE(stream.Read().has_value());
      EXPECT_TRUE(stream.Finish().ok());
    }
  }
}

TEST_F(MeasureTest, AnEditIsMeasuredAndCounts) {
  DeformStream stream(deformation());
  Open(stream, v1::DELIVERY_LATEST, Every(3));
  EXPECT_EQ(Drag(stream, 1, 2), "m.");
  stream.Send(Edit(3, {}, {VertexHandle("d", 12)}));
  EXPECT_EQ(MarkOf(stream.ReadShape()), 'm');
  EXPECT_EQ(Drag(stream, 4, 7), "..m.");
}

TEST_F(MeasureTest, WhatAnswersInThePlaceOfAnUpdateThatAsksIsMeasured) {
  DeformStream stream(deformation());
  Open(stream, v1::DELIVERY_LATEST, Every(0));
  {
    PoolGate gate(host().engine().interactive);
    for (std::uint64_t i = 1; i <= 10; ++i) {
      v1::StreamDeformRequest request;
      request.mutable_update()->set_sequence(i);
      for (const auto& target : Pulled(1)) *request.mutable_update()->add_targets() = target;
      request.mutable_update()->set_measure(i == 5);
      stream.Send(request);
    }
    stream.Ping(1);
  }
  EXPECT_EQ(MarkOf(ReadUntil(stream, 10)), 'm');
  EXPECT_EQ(Drag(stream, 11, 12), "..");
}

}  // namespace
}  // namespace arap::wire
