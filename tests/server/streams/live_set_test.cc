// Where a handle that is added to a moved shape starts.
#include "server/streams/live_set.h"

#include <complex>
#include <cstring>
#include <future>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/cost.h"
#include "arap/core/registered_mesh.h"
#include "server/runtime/metrics.h"
#include "server/runtime/worker_pool.h"
#include "server/streams/admission.h"
#include "tests/support/bounded.h"
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

// A frame that is a job for its length, here for many refinements, is shared with threads that have
// nothing to do.
TEST(LiveSetTest, ALongFrameHasTheSameBytesWhoeverHelps) {
  HandleSetEntry entry;
  entry.handles = Compiled(testing::JitteredGrid(140, 140, 3),
                           {AtVertex("a", 0), AtVertex("b", 140), AtVertex("c", 9'800)});
  std::vector<Target> targets = entry.handles->RestTargets();
  targets[2].position += Complex(30, -20);
  const DeformOptions options{DeformMode::kRigid, 100};
  ASSERT_GT(EstimateFrame(*entry.handles, options).seconds(), kLongFrameSeconds);

  runtime::Metrics metrics;
  LiveSet alone(entry);
  const auto expected = alone.Move(targets, options, metrics, {});
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(alone.helped_seconds(), 0);

  runtime::WorkerPool frames({.name = "frames", .threads = 4, .queue = 10});
  runtime::WorkerPool jobs({.name = "jobs", .threads = 1, .queue = 10, .gives_way_to = &frames});
  LiveSet helped(entry);
  // On a busy machine the helpers may come too late.
  EXPECT_TRUE(testing::Await("somebody helps", [&] {
    std::promise<Result<ShapeQuality>> moved;
    EXPECT_TRUE(jobs.TryPost([&] { moved.set_value(helped.Move(targets, options, metrics, {})); }));
    auto answer = moved.get_future();
    const auto quality = testing::Answer(answer, "a frame");
    EXPECT_TRUE(quality.has_value() && *quality == *expected);
    const auto a = helped.deformer().positions(), b = alone.deformer().positions();
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0);
    return frames.stats().helped > 0;
  }));
  EXPECT_GE(helped.helped_seconds(), 0);
}

}  // namespace
}  // namespace arap::app
