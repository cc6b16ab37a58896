// Shapes that were not measured: taken where that was asked, and nowhere else.
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "arap/v1/deformation_service.pb.h"
#include "tests/support/fake_server.h"

namespace arap::client {
namespace {

// A square of two triangles with a handle at two corners.
class MeasuredAnswersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(session_.RegisterMesh(mesh_, {}, "m"));
    ASSERT_TRUE(session_.CompileHandles("h", "m", handles_));
  }

  Result<Shape> Deform(const ShapeOptions& options) {
    return session_.Deform("h", targets_, options);
  }

  // As a server says it that has not measured.
  static void Strip(v1::Shape& shape) {
    shape.set_unmeasured(true);
    shape.set_flipped_count(0);
    shape.clear_flipped_ids();
    shape.set_energy(0);
    shape.set_mean_stretch(0);
    shape.set_max_stretch(0);
  }

  testing::FakeServer server_;
  Client client_ = Client::Connect(server_.address());
  Session session_ = client_.AttachSession("s");
  const PlanarMesh mesh_{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<Handle> handles_{{"a", VertexAnchor{0}}, {"b", VertexAnchor{2}}};
  const std::vector<HandleTarget> targets_{{"a", {{1, 2}}}, {"b", {{3, 4}}}};
};

TEST_F(MeasuredAnswersTest, ShapesAreMeasuredUnlessThatWasNotAsked) {
  server_.Change<v1::Shape>(Strip);
  const auto bare = Deform({});
  ASSERT_FALSE(bare);
  EXPECT_EQ(bare.error().message,
            "The server answered a shape without the measures that were asked for.");
  ShapeOptions none, some;
  none.deform.measure_every = 0;
  some.deform.measure_every = 2;
  none.flipped_ids = some.flipped_ids = true;
  EXPECT_FALSE(Deform(some)) << "it is the first";
  const auto taken = Deform(none);
  ASSERT_TRUE(taken) << taken.error().message;
  EXPECT_FALSE(taken->quality.measured);
  auto stream = session_.OpenStream("h", {.shape = none});
  ASSERT_TRUE(stream);
  ASSERT_TRUE(stream->Send({1, targets_, {}, {}}));
  EXPECT_TRUE(stream->Read());
  ASSERT_TRUE(stream->Edit(2, std::vector<std::string>{"a"}, {}));
  EXPECT_FALSE(stream->Read()) << "an edit is to be measured";
  // Measures that are not there are none.
  for (const auto& add : std::vector<std::function<void(v1::Shape&)>>{
           [](v1::Shape& shape) { shape.set_flipped_count(1); },
           [](v1::Shape& shape) { shape.add_flipped_ids(0); },
           [](v1::Shape& shape) { shape.set_energy(1e-9); },
           [](v1::Shape& shape) { shape.set_mean_stretch(1); },
           [](v1::Shape& shape) { shape.set_max_stretch(1); }}) {
    server_.Change<v1::Shape>([&](v1::Shape& shape) {
      Strip(shape);
      add(shape);
    });
    const auto lie = Deform(none);
    ASSERT_FALSE(lie);
    EXPECT_EQ(lie.error().message,
              "The server answered measures of a shape that it says it has not measured.");
  }
}

// What a stream makes of answers to so many updates, of which 'm' says measured and '.' not.
TEST_F(MeasuredAnswersTest, AStreamIsMeasuredAsOftenAsWasAsked) {
  const struct {
    std::uint32_t every;
    const char* marks;
    std::uint64_t asking;
    std::size_t taken;
  } cases[] = {{3, "m..m..m", 0, 7}, {3, "mmmmmmm", 0, 7}, {3, "m...", 0, 3}, {3, ".mm", 0, 0},
               {3, "mm..m", 0, 5},   {0, ".......", 0, 7}, {0, "...m", 4, 4}, {0, "....", 4, 3}};
  for (const auto& [every, marks, asking, taken] : cases) {
    const std::string said = marks;
    server_.Change<v1::Shape>([&said](v1::Shape& shape) {
      if (said[shape.sequence() - 1] == '.') Strip(shape);
    });
    StreamOptions options;
    options.shape.deform.measure_every = every;
    auto stream = session_.OpenStream("h", options);
    ASSERT_TRUE(stream);
    std::size_t count = 0;
    for (std::uint64_t i = 1; i <= said.size(); ++i) {
      ASSERT_TRUE(stream->Send({i, targets_, {}, {}, i == asking}));
      const auto event = stream->Read();
      if (!event) break;
      EXPECT_EQ(std::get<Shape>(**event).quality.measured, said[i - 1] == 'm');
      ++count;
    }
    EXPECT_EQ(count, taken) << marks << ", " << every;
  }
}

}  // namespace
}  // namespace arap::client
