// How positions come: relative to an origin, in every encoding, of some vertices; over the wire, with
// nothing of ours to read them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire::answers {
namespace {

using Points = std::vector<Complex>;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

constexpr int kWidth = 7, kHeight = 5;
constexpr double kSize = 7;
const Complex kFar(5e5, 5.4e6);  // about where the metres of a map are

// A grid whose coordinates are not round, moved.
v1::PlanarMesh Crooked(Complex at) {
  v1::PlanarMesh mesh = Grid(kWidth, kHeight);
  for (int i = 0; i < mesh.vertices_size(); i += 2) {
    const double x = mesh.vertices(i), y = mesh.vertices(i + 1);
    mesh.set_vertices(i, at.real() + x + 0.11 * std::sin(3 * y + x));
    mesh.set_vertices(i + 1, at.imag() + y + 0.07 * std::cos(2 * x - y));
  }
  return mesh;
}

// Where the handles go in a frame, from the place of the mesh on.
std::vector<Complex> Places(int frame) {
  return {{0.3 * frame, -0.1}, {7.3, 0.4 * frame}, {1, 5 + 0.2 * frame}};
}

constexpr const char* kIds[] = {"a", "b", "c"};
constexpr int kFrames = 3;

// What a client in any language does, from the documentation.
Points Read(const v1::Shape& shape) {
  const double x0 = shape.origin_size() == 2 ? shape.origin(0) : 0;
  const double y0 = shape.origin_size() == 2 ? shape.origin(1) : 0;
  std::vector<double> numbers(shape.positions64().begin(), shape.positions64().end());
  for (const float number : shape.positions()) numbers.push_back(static_cast<double>(number));
  const std::string& bytes = shape.packed_positions();
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  if (shape.scale() == 0) {
    for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
      const std::uint32_t bits = std::uint32_t{byte(i)} | std::uint32_t{byte(i + 1)} << 8u |
                                 std::uint32_t{byte(i + 2)} << 16u |
                                 std::uint32_t{byte(i + 3)} << 24u;
      numbers.push_back(static_cast<double>(std::bit_cast<float>(bits)));
    }
  } else {
    for (std::size_t i = 0; i + 2 <= bytes.size(); i += 2) {
      const int value = byte(i) + 256 * byte(i + 1);
      numbers.push_back(shape.scale() * (value > 32767 ? value - 65536 : value));
    }
  }
  Points points;
  for (std::size_t i = 0; i + 2 <= numbers.size(); i += 2) {
    points.emplace_back(x0 + numbers[i], y0 + numbers[i + 1]);
  }
  return points;
}

// The largest distance along an axis, from points that lie `at` there.
double Off(const Points& points, const Points& exact, Complex at = {}) {
  EXPECT_EQ(points.size(), exact.size());
  double off = 0;
  for (std::size_t i = 0; i < std::min(points.size(), exact.size()); ++i) {
    const Complex by = points[i] - at - exact[i];
    off = std::max({off, std::abs(by.real()), std::abs(by.imag())});
  }
  return off;
}

// What one way of asking has answered: a shape per frame, and which vertices they are of.
struct Answers {
  std::vector<v1::Shape> shapes;
  std::vector<std::uint32_t> vertices;
};

class AnswerTest : public WireTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(CreateSession("s").ok());
    for (const auto& [name, at] : {std::pair("near", Complex()), std::pair("far", kFar)}) {
      ASSERT_TRUE(Register("s", name, Crooked(at)).ok());
      const auto top = static_cast<std::uint32_t>((kWidth + 1) * kHeight);
      ASSERT_TRUE(Compile("s", name, name,
                          {VertexHandle("a", 0), VertexHandle("b", kWidth), VertexHandle("c", top)})
                      .ok());
    }
  }

  static Complex PlaceOf(const std::string& set) { return set == "far" ? kFar : Complex(); }

  static std::vector<v1::HandleTarget> Targets(const std::string& set, int frame) {
    std::vector<v1::HandleTarget> targets;
    const auto places = Places(frame);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Complex place = PlaceOf(set) + places[k];
      targets.push_back(TargetAt(kIds[k], place.real(), place.imag()));
    }
    return targets;
  }

  Answers Unary(const std::string& set, const v1::DeformOptions& options) {
    Answers answers;
    for (int frame = 0; frame < kFrames; ++frame) {
      v1::DeformResponse response;
      const auto status = Call(&Deformation::Deform, UnaryRequest(set, options, frame), &response);
      EXPECT_TRUE(status.ok()) << status.error_message();
      answers.shapes.push_back(response.shape());
      answers.vertices.assign(response.vertices().begin(), response.vertices().end());
    }
    return answers;
  }

  static v1::DeformRequest UnaryRequest(const std::string& set, const v1::DeformOptions& options,
                                        int frame = 0) {
    v1::DeformRequest request;
    request.set_session_id("s");
    request.set_handle_set_id(set);
    const auto targets = Targets(set, frame);
    request.mutable_targets()->Assign(targets.begin(), targets.end());
    *request.mutable_options() = options;
    return request;
  }

  static v1::DeformTrackRequest TrackRequest(const std::string& set,
                                             const v1::DeformOptions& options) {
    v1::DeformTrackRequest request;
    request.set_session_id("s");
    request.set_handle_set_id(set);
    for (const char* id : kIds) request.add_handle_ids(id);
    for (int frame = 0; frame < kFrames; ++frame) {
      v1::TrackFrame& out = *request.add_frames();
      for (const Complex place : Places(frame)) {
        out.add_positions((PlaceOf(set) + place).real());
        out.add_positions((PlaceOf(set) + place).imag());
      }
    }
    *request.mutable_options() = options;
    return request;
  }

  Answers Track(const std::string& set, const v1::DeformOptions& options) {
    Answers answers;
    grpc::ClientContext context;
    SetDeadline(context);
    const auto reader = deformation().DeformTrack(&context, TrackRequest(set, options));
    v1::DeformTrackResponse response;
    while (reader->Read(&response)) {
      EXPECT_TRUE(response.vertices().empty() || answers.shapes.empty()) << "said once";
      if (answers.shapes.empty()) {
        answers.vertices.assign(response.vertices().begin(), response.vertices().end());
      }
      answers.shapes.push_back(response.shape());
    }
    const auto status = reader->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    return answers;
  }

  static v1::StreamDeformRequest OpenRequest(const std::string& set,
                                             const v1::DeformOptions& options) {
    v1::StreamDeformRequest open;
    open.mutable_open()->set_session_id("s");
    open.mutable_open()->set_handle_set_id(set);
    open.mutable_open()->set_delivery(v1::DELIVERY_EVERY);
    *open.mutable_open()->mutable_options() = options;
    return open;
  }

  Answers Stream(const std::string& set, const v1::DeformOptions& options) {
    Answers answers;
    DeformStream stream(deformation());
    stream.Send(OpenRequest(set, options));
    const auto opened = stream.Read();
    if (!opened || !opened->has_opened()) {
      ADD_FAILURE() << "not opened";
      return answers;
    }
    const auto& vertices = opened->opened().vertices();
    answers.vertices.assign(vertices.begin(), vertices.end());
    for (int frame = 0; frame < kFrames; ++frame) {
      stream.Update(static_cast<std::uint64_t>(frame + 1), Targets(set, frame));
      answers.shapes.push_back(stream.ReadShape());
    }
    stream.HalfClose();
    EXPECT_FALSE(stream.Read());
    EXPECT_TRUE(stream.Finish().ok());
    return answers;
  }

  // Asks in every way, and looks at what each has answered.
  void InEveryWay(const std::string& set, const v1::DeformOptions& options,
                  const std::function<void(const Answers&)>& look) {
    const std::pair<const char*, Answers> ways[] = {{"Deform", Unary(set, options)},
                                                    {"DeformTrack", Track(set, options)},
                                                    {"StreamDeform", Stream(set, options)}};
    for (const auto& [way, answers] : ways) {
      SCOPED_TRACE(way);
      ASSERT_EQ(answers.shapes.size(), std::size_t{kFrames});
      look(answers);
    }
  }

  // The frames in double precision.
  std::vector<Points> Exact(const std::string& set) {
    v1::DeformOptions options;
    options.set_float64(true);
    std::vector<Points> frames;
    for (const v1::Shape& shape : Unary(set, options).shapes) frames.push_back(Read(shape));
    return frames;
  }
};

v1::DeformOptions Encoded(v1::PositionEncoding encoding) {
  v1::DeformOptions options;
  options.set_relative_to_origin(true);
  options.set_encoding(encoding);
  return options;
}

TEST_F(AnswerTest, FarFromTheOriginShapesAreThoseAtIt) {
  const std::vector<Points> exact = Exact("near");
  for (const auto encoding : {v1::POSITION_ENCODING_UNSPECIFIED, v1::POSITION_ENCODING_FLOAT32,
                              v1::POSITION_ENCODING_FLOAT32_LE}) {
    for (const std::string set : {"near", "far"}) {
      SCOPED_TRACE(set + " " + v1::PositionEncoding_Name(encoding));
      InEveryWay(set, Encoded(encoding), [&](const Answers& answers) {
        EXPECT_THAT(answers.vertices, IsEmpty());
        for (std::size_t i = 0; i < exact.size(); ++i) {
          ASSERT_EQ(answers.shapes[i].origin_size(), 2);
          EXPECT_LT(Off(Read(answers.shapes[i]), exact[i], PlaceOf(set)), 1e-6 * kSize);
        }
      });
    }
  }
}

TEST_F(AnswerTest, WhoDoesNotKnowOfOriginsGetsNone) {
  const std::vector<Points> exact = Exact("near");
  InEveryWay("far", {}, [&](const Answers& answers) {
    for (std::size_t i = 0; i < exact.size(); ++i) {
      EXPECT_THAT(answers.shapes[i].origin(), IsEmpty());
      const double off = Off(Read(answers.shapes[i]), exact[i], kFar);
      EXPECT_GT(off, 0.01) << "what floats lose there";
      EXPECT_LE(off, 0.25 + 1e-6);
    }
  });
}

TEST_F(AnswerTest, EncodingsDecodeToTheDefaultWithinTheirBounds) {
  const std::vector<Points> exact = Exact("far");
  InEveryWay("far", Encoded(v1::POSITION_ENCODING_FLOAT32_LE), [&](const Answers& answers) {
    const Answers plain = Unary("far", Encoded(v1::POSITION_ENCODING_FLOAT32));
    for (std::size_t i = 0; i < exact.size(); ++i) {
      EXPECT_THAT(answers.shapes[i].positions(), IsEmpty());
      EXPECT_EQ(answers.shapes[i].packed_positions().size(), 8 * exact[i].size());
      EXPECT_EQ(Read(answers.shapes[i]), Read(plain.shapes[i]));
    }
  });
  InEveryWay("far", Encoded(v1::POSITION_ENCODING_INT16_LE), [&](const Answers& answers) {
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const v1::Shape& shape = answers.shapes[i];
      EXPECT_THAT(shape.positions(), IsEmpty());
      EXPECT_EQ(shape.packed_positions().size(), 4 * exact[i].size());
      EXPECT_LT(shape.scale(), 1.5 * kSize / 65534);
      EXPECT_LE(Off(Read(shape), exact[i]), 0.5 * shape.scale() + 1e-8);
      EXPECT_GT(Off(Read(shape), exact[i]), 0.1 * shape.scale());
    }
  });
  // Without an origin bytes are the numbers of the default.
  v1::DeformOptions plain;
  plain.set_encoding(v1::POSITION_ENCODING_FLOAT32_LE);
  EXPECT_EQ(Read(Unary("near", plain).shapes[0]), Read(Unary("near", {}).shapes[0]));
  EXPECT_THAT(Unary("near", plain).shapes[0].origin(), IsEmpty());
}

TEST_F(AnswerTest, SomeVerticesAreThoseOfTheWhole) {
  const std::vector<Points> exact = Exact("far");
  std::vector<std::uint32_t> boundary;
  for (std::uint32_t v = 0; v < (kWidth + 1) * (kHeight + 1); ++v) {
    const std::uint32_t x = v % (kWidth + 1), y = v / (kWidth + 1);
    if (x == 0 || x == kWidth || y == 0 || y == kHeight) boundary.push_back(v);
  }
  const std::vector<std::uint32_t> subset{47, 3, 12, 0};
  for (const bool all_round : {false, true}) {
    const std::vector<std::uint32_t>& vertices = all_round ? boundary : subset;
    for (const auto encoding : {v1::POSITION_ENCODING_FLOAT32, v1::POSITION_ENCODING_FLOAT32_LE,
                                v1::POSITION_ENCODING_INT16_LE}) {
      v1::DeformOptions options = Encoded(encoding);
      options.set_boundary_only(all_round);
      if (!all_round) options.mutable_vertex_subset()->Assign(subset.begin(), subset.end());
      InEveryWay("far", options, [&](const Answers& answers) {
        EXPECT_THAT(answers.vertices, ElementsAreArray(vertices));
        for (std::size_t i = 0; i < exact.size(); ++i) {
          Points wanted;
          for (const std::uint32_t v : vertices) wanted.push_back(exact[i][v]);
          const double bound = std::max(0.5 * answers.shapes[i].scale() + 1e-8, 1e-6 * kSize);
          EXPECT_LE(Off(Read(answers.shapes[i]), wanted), bound);
        }
      });
    }
  }
  // In double precision too.
  v1::DeformOptions options;
  options.set_float64(true);
  options.add_vertex_subset(9);
  EXPECT_EQ(Read(Unary("far", options).shapes[1]), Points{exact[1][9]});
}

TEST_F(AnswerTest, WhatCannotBeIsNamed) {
  const auto with = [](const std::function<void(v1::DeformOptions&)>& change) {
    v1::DeformOptions options;
    change(options);
    return options;
  };
  const struct {
    v1::DeformOptions options;
    const char* reason;
    const char* field;
  } cases[] = {
      {with([](auto& o) { o.set_encoding(static_cast<v1::PositionEncoding>(9)); }),
       "INVALID_OPTION", "options.encoding"},
      {with([](auto& o) {
         o.set_float64(true);
         o.set_encoding(v1::POSITION_ENCODING_INT16_LE);
       }),
       "INVALID_OPTION", "options.encoding"},
      {with([](auto& o) {
         o.set_boundary_only(true);
         o.add_vertex_subset(1);
       }),
       "INVALID_OPTION", "options.vertex_subset"},
      {with([](auto& o) {
         o.add_vertex_subset(1);
         o.add_vertex_subset(48);
       }),
       "INDEX_OUT_OF_RANGE", "options.vertex_subset[1]"},
      {with([](auto& o) {
         for (const std::uint32_t v : {5u, 7u, 5u}) o.add_vertex_subset(v);
       }),
       "REPEATED_INDEX", "options.vertex_subset[2]"},
      {with([](auto& o) { o.mutable_vertex_subset()->Resize(49, 0); }), "ARRAY_LENGTH",
       "options.vertex_subset"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(std::string(c.reason) + " " + c.field);
    v1::DeformResponse response;
    const auto unary = Call(&Deformation::Deform, UnaryRequest("near", c.options), &response);
    EXPECT_THAT(ExpectError(unary, grpc::INVALID_ARGUMENT, c.reason).fields, ElementsAre(c.field));

    grpc::ClientContext context;
    SetDeadline(context);
    const auto reader = deformation().DeformTrack(&context, TrackRequest("near", c.options));
    v1::DeformTrackResponse frame;
    EXPECT_FALSE(reader->Read(&frame));
    EXPECT_THAT(ExpectError(reader->Finish(), grpc::INVALID_ARGUMENT, c.reason).fields,
                ElementsAre(c.field));

    DeformStream stream(deformation());
    stream.Send(OpenRequest("near", c.options));
    EXPECT_FALSE(stream.Read());
    EXPECT_THAT(ExpectError(stream.Finish(), grpc::INVALID_ARGUMENT, c.reason).fields,
                ElementsAre(c.field));
  }
}

TEST_F(AnswerTest, BeyondFloatsIsWhatIsTooLargeNotWhatIsTooFar) {
  const auto request = [](double dx, double dy, const v1::DeformOptions& options) {
    v1::DeformRequest out = UnaryRequest("near", options);
    for (v1::HandleTarget& target : *out.mutable_targets()) target.set_x(target.x() + dx);
    out.mutable_targets(1)->set_y(dy);
    return out;
  };
  v1::DeformResponse response;
  const auto relative = Encoded(v1::POSITION_ENCODING_FLOAT32);
  ASSERT_TRUE(Call(&Deformation::Deform, request(1e39, 0, relative), &response).ok());
  EXPECT_DOUBLE_EQ(response.shape().origin(0), 1e39);
  ExpectError(Call(&Deformation::Deform, request(0, 1e39, relative), &response), grpc::INTERNAL,
              "NUMERICAL");
  const auto integers = Encoded(v1::POSITION_ENCODING_INT16_LE);
  ASSERT_TRUE(Call(&Deformation::Deform, request(0, 1e39, integers), &response).ok());
  EXPECT_GT(response.shape().scale(), 1e33);
}

}  // namespace
}  // namespace arap::wire::answers
