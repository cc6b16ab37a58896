// Where a handle that is added to a moved shape starts.
#include "server/streams/live_set.h"

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/registered_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"

namespace arap::app {
namespace {

using testing::AtVertex;
using testing::Square;

std::shared_ptr<const CompiledHandles> Compiled(const PlanarMesh& mesh,
                                                const std::vector<Handle>& handles) {
  return *CompiledHandles::Compile(*RegisteredMesh::Register(mesh, {}), handles);
}

std::vector<Target> Poses(const CompiledHandles& set, std::span<const Complex> positions) {
  return PosesOf(*set.mesh(), set.handles(), positions);
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
  const auto set = Compiled(Square(), {AtVertex("v", 2), point, in_triangle, snapped});
  const auto poses = Poses(*set, now);
  ASSERT_EQ(poses.size(), 4u);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PlacedHandle& placed = set->handles()[i];
    EXPECT_LT(std::abs(poses[i].position - (a * placed.rest + b)), 1e-9) << placed.handle.id;
    EXPECT_NEAR(poses[i].angle, std::arg(a), 1e-9) << placed.handle.id;
    EXPECT_NEAR(poses[i].scale, 2, 1e-9) << placed.handle.id;
  }
}

TEST(PoseTest, CollapsedTriangleGivesNoRotation) {
  const std::vector<Complex> now(4, Complex(3, 3));
  const Target pose = Poses(*Compiled(Square(), {AtVertex("v", 1)}), now).front();
  EXPECT_EQ(pose.position, Complex(3, 3));
  EXPECT_EQ(pose.angle, 0);
  EXPECT_EQ(pose.scale, 1);
}

}  // namespace
}  // namespace arap::app
