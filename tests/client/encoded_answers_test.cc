// Shapes in other encodings and of some vertices: what a server answers is checked against what was
// asked for.
#include <functional>

#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "arap/v1/deformation_service.pb.h"
#include "tests/support/fake_server.h"

namespace arap::client {
namespace {

using ::testing::ElementsAre;
using testing::FakeServer;
using ::testing::HasSubstr;

// A square of two triangles; the server answers it at rest, as floats, unless it is told otherwise.
class EncodedAnswersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const PlanarMesh mesh{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    ASSERT_TRUE(session_.RegisterMesh(mesh, {}, "m"));
    ASSERT_TRUE(session_.CompileHandles("h", "m", std::vector<Handle>{{"a", VertexAnchor{0}}}));
  }

 public:  // for pointers to them
  Result<Shape> Deform(const ShapeOptions& options) {
    return session_.Deform("h", std::vector<HandleTarget>{{"a", {{1, 2}}}}, options);
  }

  // The shape of the only frame of a track, and that of the only update of a stream.
  Result<Shape> Track(const ShapeOptions& options) {
    Result<Shape> last = Fail(FaultKind::kInternal, "no frame");
    const std::vector<std::vector<Target>> frames(1, std::vector<Target>(1));
    const Status track = session_.DeformTrack("h", std::vector<std::string>{"a"}, frames, options,
                                              [&](Shape&& shape) {
                                                last = std::move(shape);
                                                return true;
                                              });
    return track ? last : Fail(track.error());
  }
  Result<Shape> Stream(const ShapeOptions& options) {
    auto stream = session_.OpenStream("h", {.shape = options});
    if (!stream) return Fail(stream.error());
    EXPECT_TRUE(stream->Send({1, {{"a", {{1, 2}}}}, {}, {}}));
    auto event = stream->Read();
    if (!event) return Fail(event.error());
    return std::get<Shape>(**std::move(event));
  }

 protected:
  // Every call refuses what `change` makes of shapes, with a fault that says so.
  void ExpectRefused(const ShapeOptions& options, const char* says,
                     std::function<void(v1::Shape&)> change) {
    server_.Change<v1::Shape>(std::move(change));
    for (const auto ask :
         {&EncodedAnswersTest::Deform, &EncodedAnswersTest::Track, &EncodedAnswersTest::Stream}) {
      const auto shape = (this->*ask)(options);
      ASSERT_FALSE(shape) << says;
      EXPECT_EQ(shape.error().kind, FaultKind::kInternal);
      EXPECT_THAT(shape.error().message, HasSubstr(says));
    }
  }

  // Every call says that its positions are of these vertices.
  void AnswerOf(const std::vector<std::uint32_t>& vertices) {
    const auto say = [vertices](auto* out) { out->Assign(vertices.begin(), vertices.end()); };
    server_.Change<v1::DeformResponse>(
        [say](v1::DeformResponse& response) { say(response.mutable_vertices()); });
    server_.Change<v1::DeformTrackResponse>(
        [say](v1::DeformTrackResponse& response) { say(response.mutable_vertices()); });
    server_.Change<v1::StreamDeformResponse>([say](v1::StreamDeformResponse& response) {
      if (response.has_opened()) say(response.mutable_opened()->mutable_vertices());
    });
  }

  FakeServer server_;
  Client client_ = Client::Connect(server_.address());
  Session session_ = client_.AttachSession("s");
};

TEST_F(EncodedAnswersTest, OriginsAreAdded) {
  server_.Change<v1::Shape>([](v1::Shape& shape) {
    shape.add_origin(5e5);
    shape.add_origin(5.4e6);
    shape.set_positions(7, 0.125F);
  });
  for (const auto ask :
       {&EncodedAnswersTest::Deform, &EncodedAnswersTest::Track, &EncodedAnswersTest::Stream}) {
    const auto shape = (this->*ask)({});
    ASSERT_TRUE(shape) << shape.error().message;
    EXPECT_EQ(shape->positions[2], Complex(500001, 5400001));
    EXPECT_EQ(shape->positions[3], Complex(500000, 5400000.125));
    EXPECT_LT(shape->position_error, 1e-7);
  }
}

TEST_F(EncodedAnswersTest, FitTheEncodingThatWasAskedFor) {
  const ShapeOptions floats{.encoding = PositionEncoding::kFloat32Le};
  const ShapeOptions integers{.encoding = PositionEncoding::kInt16Le};
  const ShapeOptions exact{.float64 = true};
  // A server that knows no encodings answers floats.
  ExpectRefused(floats, "another precision", [](v1::Shape&) {});
  ExpectRefused(integers, "another precision", [](v1::Shape&) {});
  ExpectRefused(exact, "an origin", [](v1::Shape& shape) { shape.mutable_origin()->Resize(2, 1); });
  ExpectRefused({}, "an origin", [](v1::Shape& shape) { shape.add_origin(1); });
  ExpectRefused({}, "not finite", [](v1::Shape& shape) {
    shape.mutable_origin()->Resize(2, std::numeric_limits<double>::quiet_NaN());
  });
  const auto packed = [](std::size_t bytes, std::function<void(v1::Shape&)> more = {}) {
    return [bytes, more](v1::Shape& shape) {
      shape.clear_positions();
      shape.set_packed_positions(std::string(bytes, '\0'));
      shape.mutable_origin()->Resize(2, 1);
      if (more) more(shape);
    };
  };
  ExpectRefused(floats, "half a position", packed(31));
  ExpectRefused(floats, "a shape of 3 vertices", packed(24));
  ExpectRefused(integers, "half a position", packed(15));
  ExpectRefused(integers, "a shape of 5 vertices", packed(20));
  ExpectRefused(integers, "without an origin",
                packed(16, [](v1::Shape& shape) { shape.clear_origin(); }));
  ExpectRefused(integers, "a scale", packed(16, [](v1::Shape& shape) { shape.set_scale(-1); }));

  server_.Change<v1::Shape>(packed(16, [](v1::Shape& shape) {
    shape.mutable_packed_positions()->replace(0, 4, "\x02\x00\xff\xff", 4);
    shape.set_scale(0.5);
  }));
  const auto shape = Deform(integers);
  ASSERT_TRUE(shape) << shape.error().message;
  EXPECT_EQ(shape->positions[0], Complex(2, 0.5));
  EXPECT_EQ(shape->position_error, 0.25);
}

TEST_F(EncodedAnswersTest, AreOfTheVerticesThatWereAskedFor) {
  const ShapeOptions some{.vertex_subset = {3, 0}};
  const ShapeOptions boundary{.boundary_only = true};
  const auto two = [](v1::Shape& shape) { shape.mutable_positions()->Truncate(4); };
  server_.Change<v1::Shape>(two);
  for (const auto ask :
       {&EncodedAnswersTest::Deform, &EncodedAnswersTest::Track, &EncodedAnswersTest::Stream}) {
    AnswerOf({3, 0});
    const auto shape = (this->*ask)(some);
    ASSERT_TRUE(shape) << shape.error().message;
    EXPECT_THAT(shape->positions, ElementsAre(Complex(0, 0), Complex(1, 0)));
    EXPECT_THAT(shape->vertices, ElementsAre(3, 0));
    EXPECT_FALSE((this->*ask)({})) << "that nobody has asked for";
    EXPECT_FALSE((this->*ask)(boundary)) << "that do not ascend";
    AnswerOf({0, 3});
    EXPECT_FALSE((this->*ask)(some)) << "in another order";
    EXPECT_TRUE((this->*ask)(boundary));
    AnswerOf({0, 4});
    EXPECT_FALSE((this->*ask)(boundary)) << "that is not there";
    AnswerOf({});
    EXPECT_FALSE((this->*ask)(some)) << "not said";
    EXPECT_FALSE((this->*ask)(boundary)) << "not said";
  }
  AnswerOf({3, 0});
  ExpectRefused(some, "4 positions, not 2", [](v1::Shape&) {});
}

}  // namespace
}  // namespace arap::client
