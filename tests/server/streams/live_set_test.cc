// Where a handle that is added to a moved shape starts.
#include "server/streams/live_set.h"

#include <complex>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/registered_mesh.h"
#include "tests/support/meshes.h"

namespace arap::app {
namespace {

using testing::Square;

Handle AtVertex(const std::string& id, std::uint32_t vertex) { return {id, VertexAnchor{vertex}}; }

PlacedHandle Placed(const Handle& handle) {
  const auto set = CompiledHandles::Compile(*RegisteredMesh::Register(Square(), {}), {handle});
  EXPECT_TRUE(set);
  return (*set)->handles().front();
}

TEST(PoseTest, EveryKindOfAnchorFollowsTheShape) {
  // Turned by a quarter, doubled, moved.
  const Complex a(0, 2);
  const Complex b(5, -1);
  std::vector<Complex> now;
  for (const Complex& vertex : Square().vertices) now.push_back(a * vertex + b);

  Handle point = AtVertex("p", 0);
  point.anchor = PointAnchor{{0.25, 0.5}};
  Handle in_triangle = AtVertex("t", 0);
  in_triangle.anchor = TriangleAnchor{1, {0.5, 0.25, 0.25}};
  Handle snapped = AtVertex("n", 0);
  snapped.anchor = PointAnchor{{0.3, -7}};
  snapped.outside = Outside::kSnap;
  for (const Handle& handle : {AtVertex("v", 2), point, in_triangle, snapped}) {
    const PlacedHandle placed = Placed(handle);
    const Target pose = PoseOf(Square(), placed, now);
    EXPECT_LT(std::abs(pose.position - (a * placed.rest + b)), 1e-9) << handle.id;
    EXPECT_NEAR(pose.angle, std::arg(a), 1e-9) << handle.id;
    EXPECT_NEAR(pose.scale, 2, 1e-9) << handle.id;
  }
}

TEST(PoseTest, CollapsedTriangleGivesNoRotation) {
  const std::vector<Complex> now(4, Complex(3, 3));
  const Target pose = PoseOf(Square(), Placed(AtVertex("v", 1)), now);
  EXPECT_EQ(pose.position, Complex(3, 3));
  EXPECT_EQ(pose.angle, 0);
  EXPECT_EQ(pose.scale, 1);
}

}  // namespace
}  // namespace arap::app
