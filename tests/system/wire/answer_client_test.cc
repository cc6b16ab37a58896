// The client library far from the origin, in every encoding and of some vertices, against a server.
#include <algorithm>

#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "tests/support/must.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire::answer_client {
namespace {

using client::PositionEncoding;
using client::Session;
using client::Shape;
using client::ShapeOptions;
using ::testing::ElementsAre;
using testing::Must;
using ::testing::SizeIs;

const Complex kFar(5e5, 5.4e6);
constexpr double kSize = 6;
constexpr std::uint32_t kColumns = 7, kRows = 5;

PlanarMesh GridAt(Complex at) {
  PlanarMesh mesh;
  for (std::uint32_t v = 0; v < kColumns * kRows; ++v) {
    const double x = v % kColumns, y = v / kColumns;
    mesh.vertices.push_back(at + Complex(x + 0.1 * std::sin(5 * y), y + 0.1 * std::cos(3 * x)));
  }
  for (std::uint32_t v = 0; v + kColumns < kColumns * kRows; ++v) {
    if ((v + 1) % kColumns == 0) continue;
    mesh.triangles.push_back({v, v + 1, v + kColumns});
    mesh.triangles.push_back({v + 1, v + kColumns + 1, v + kColumns});
  }
  return mesh;
}

// Frame i of the handles at vertices 0 and kColumns - 1.
std::vector<Target> FrameAt(Complex at, int i) {
  return {{at + Complex(0, 0.3 * i)}, {at + Complex(5, 1 + 0.7 * i)}};
}

class AnswerClientTest : public WireTest {
 protected:
  void SetUp() override {
    connected_ = client::Client::Connect(host().addresses().front());
    session_ = Must(connected_->CreateSession({"s", {}, {}}));
    const std::vector<Handle> handles{{"l", VertexAnchor{0}}, {"r", VertexAnchor{kColumns - 1}}};
    for (const auto& [name, at] : {std::pair("near", Complex()), std::pair("far", kFar)}) {
      Must(session_->RegisterMesh(GridAt(at), {}, name));
      Must(session_->CompileHandles(name, name, handles));
    }
  }

  // Three frames by single calls, as a track and through a stream.
  std::vector<std::vector<Shape>> InEveryWay(const std::string& set, const ShapeOptions& options) {
    const Complex at = set == "far" ? kFar : Complex();
    std::vector<std::vector<Shape>> ways(3);
    std::vector<std::vector<Target>> frames;
    auto stream = Must(session_->OpenStream(set, {client::Delivery::kEvery, options}));
    for (int i = 0; i < 3; ++i) {
      const auto& targets = frames.emplace_back(FrameAt(at, i));
      const std::vector<HandleTarget> named{{"l", targets[0]}, {"r", targets[1]}};
      ways[0].push_back(Must(session_->Deform(set, named, options)));
      EXPECT_TRUE(stream.Send({static_cast<std::uint64_t>(i + 1), named, {}, {}}));
      ways[2].push_back(std::get<Shape>(*Must(stream.Read())));
    }
    const std::vector<std::string> ids{"l", "r"};
    const Status track = session_->DeformTrack(set, ids, frames, options, [&](Shape&& shape) {
      ways[1].push_back(std::move(shape));
      return true;
    });
    EXPECT_TRUE(track) << track.error().message;
    return ways;
  }

  std::optional<client::Client> connected_;
  std::optional<Session> session_;
};

TEST_F(AnswerClientTest, ADragIsAsExactFarAwayAsAtTheOrigin) {
  const auto near = InEveryWay("near", {.float64 = true})[0];
  for (const PositionEncoding encoding :
       {PositionEncoding::kFloat32, PositionEncoding::kFloat32Le, PositionEncoding::kInt16Le}) {
    const bool integers = encoding == PositionEncoding::kInt16Le;
    for (const auto& shapes : InEveryWay("far", {.encoding = encoding})) {
      ASSERT_THAT(shapes, SizeIs(3));
      for (std::size_t i = 0; i < 3; ++i) {
        const double told = shapes[i].position_error;
        EXPECT_GT(told, 0);
        EXPECT_LT(told, integers ? 2e-5 * kSize : 1e-6 * kSize);
        for (std::size_t v = 0; v < kColumns * kRows; ++v) {
          const Complex off = shapes[i].positions[v] - kFar - near[i].positions[v];
          ASSERT_LE(std::max(std::abs(off.real()), std::abs(off.imag())), told + 1e-8);
        }
      }
    }
  }
}

TEST_F(AnswerClientTest, SomeVerticesAreThoseOfTheWhole) {
  const auto whole = InEveryWay("far", {.float64 = true})[0];
  for (const bool boundary : {false, true}) {
    ShapeOptions options;
    options.float64 = true;
    options.boundary_only = boundary;
    if (!boundary) options.vertex_subset = {33, 2, 17};
    for (const auto& shapes : InEveryWay("far", options)) {
      ASSERT_THAT(shapes, SizeIs(3));
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& vertices = shapes[i].vertices;
        ASSERT_THAT(vertices, SizeIs(boundary ? 2 * (kColumns + kRows) - 4 : 3));
        if (!boundary) {
          EXPECT_THAT(vertices, ElementsAre(33, 2, 17));
        }
        ASSERT_EQ(shapes[i].positions.size(), vertices.size());
        for (std::size_t k = 0; k < vertices.size(); ++k) {
          // A track takes several frames at a time, which rounds otherwise.
          EXPECT_LT(std::abs(shapes[i].positions[k] - whole[i].positions[vertices[k]]), 1e-8);
        }
      }
    }
  }
}

TEST_F(AnswerClientTest, ShapesAreMeasuredAsOftenAsWasAsked) {
  const auto all = InEveryWay("near", {.float64 = true});
  for (const std::uint32_t every : {0u, 2u}) {
    ShapeOptions options;
    options.float64 = options.flipped_ids = true;
    options.deform.measure_every = every;
    const auto ways = InEveryWay("near", options);
    for (std::size_t way = 0; way < ways.size(); ++way) {
      ASSERT_THAT(ways[way], SizeIs(3));
      for (std::size_t i = 0; i < 3; ++i) {
        const Shape& shape = ways[way][i];
        const bool alone = way == 0;
        EXPECT_EQ(shape.positions, all[way][i].positions);
        EXPECT_EQ(shape.quality.worst_handle_error, all[way][i].quality.worst_handle_error);
        ASSERT_EQ(shape.quality.measured, every > 0 && (alone || i % 2 == 0)) << way << ", " << i;
        if (shape.quality.measured) {
          EXPECT_EQ(shape.quality, all[way][i].quality);
        }
      }
    }
  }
}

TEST_F(AnswerClientTest, WhatCannotBeIsNamed) {
  const std::vector<HandleTarget> targets{{"l", {}}, {"r", {{5, 1}}}};
  const std::pair<ShapeOptions, const char*> cases[] = {
      {{.float64 = true, .encoding = PositionEncoding::kInt16Le}, "options.encoding"},
      {{.boundary_only = true, .vertex_subset = {1}}, "options.vertex_subset"},
      {{.vertex_subset = {1, 35}}, "options.vertex_subset[1]"},
  };
  for (const auto& [options, field] : cases) {
    const auto shape = session_->Deform("near", targets, options);
    ASSERT_FALSE(shape) << field;
    EXPECT_EQ(shape.error().field, field);
    EXPECT_EQ(session_->OpenStream("near", {.shape = options}).error().field, field);
  }
}

}  // namespace
}  // namespace arap::wire::answer_client
