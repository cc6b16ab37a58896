// The inverse map, and several frames at once.
#include "arap/core/pick.h"

#include "tests/core/deform/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

TEST(PickTest, TakesADeformedPointBackToRest) {
  PlanarMesh mesh = JitteredGrid(12, 9, 3);
  std::swap(mesh.triangles[17][0], mesh.triangles[17][1]);  // clockwise: it will be turned
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 5, 2));
  const auto shape = Deform(set, RandomTargets(*set, 1, 4));
  const Picker picker(set);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<double, 3> b{0.5, 0.3, 0.2};
    Complex deformed = 0, rest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      deformed += b[k] * shape[mesh.triangles[t][k]];
      rest += b[k] * mesh.vertices[mesh.triangles[t][k]];
    }
    const auto pick = picker.Find(shape, deformed);
    ASSERT_TRUE(pick.has_value());
    EXPECT_LE(pick->triangle, t);  // the lowest, where they overlap
    if (pick->triangle != t) continue;
    EXPECT_LE(std::abs(pick->rest - rest), 1e-9);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(pick->barycentric[k], b[k], 1e-9);
  }
  EXPECT_FALSE(picker.Find(shape, {1000, 1000}).has_value());
}

TEST(PickTest, TheNearerLayerWins) {
  // Two squares; the second is dragged over the first.
  PlanarMesh mesh{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {3, 0}, {3, 1}, {2, 1}},
                  {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}};
  const auto registered = Register(mesh);
  for (const double depth : {-1.0, 0.0, 1.0}) {
    Handle second = OnVertex("second", 4);
    second.depth = depth;
    const auto set = Compile(registered, {OnVertex("first", 0), second});
    const auto shape = Deform(set, {{0, 0, 1}, {0, 0, 1}});
    const auto pick = Picker(set).Find(shape, {0.75, 0.25});
    ASSERT_TRUE(pick.has_value());
    EXPECT_EQ(pick->triangle, depth > 0 ? 2u : 0u);
  }
}

TEST(UpdateManyTest, AShapeDoesNotDependOnItsCompany) {
  for (const std::size_t handles : {6u, 90u}) {
    const PlanarMesh mesh = JitteredGrid(25, 25, 3);
    const auto set = Compile(Register(mesh), RandomHandles(mesh, handles, 2));
    for (const DeformOptions& options :
         {DeformOptions{}, DeformOptions{DeformMode::kRigid, 3},
          DeformOptions{DeformMode::kBaseline, 0}, DeformOptions{DeformMode::kSimilarity, 0}}) {
      Deformer many(set, 7), alone(set, 7), one(set);
      std::vector<std::vector<Target>> targets;
      for (std::uint64_t i = 0; i < 7; ++i) targets.push_back(RandomTargets(*set, 5, i));
      for (const std::size_t count : {1u, 2u, 3u, 5u, 7u}) {
        std::vector<std::span<const Target>> frames(targets.begin(),
                                                    targets.begin() + static_cast<int>(count));
        std::vector<ShapeQuality> qualities(count);
        ASSERT_TRUE(many.UpdateMany(frames, options, qualities).has_value());
        for (std::size_t i = 0; i < count; ++i) {
          const ShapeQuality quality = Must(alone.Update(targets[i], options));
          EXPECT_EQ(quality.energy, qualities[i].energy);
          EXPECT_TRUE(std::equal(alone.positions().begin(), alone.positions().end(),
                                 many.positions(i).begin()))
              << "frame " << i << " of " << count << ", " << handles << " handles";
          Must(one.Update(targets[i], options));
          EXPECT_LE(RelativeDistance(one.positions(), many.positions(i)), 1e-11);
        }
      }
    }
  }
}

TEST(UpdateManyTest, AFaultLeavesEveryShapeAlone) {
  const PlanarMesh mesh = JitteredGrid(5, 5, 3);
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 4, 2));
  Deformer deformer(set, 2);
  const auto good = RandomTargets(*set, 1, 1);
  auto bad = good;
  bad[2].position = std::nan("");
  const std::vector<std::span<const Target>> frames{good, bad};
  std::vector<ShapeQuality> qualities(2);
  const Status status = deformer.UpdateMany(frames, {}, qualities);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().kind, FaultKind::kNonFiniteTarget);
  EXPECT_TRUE(
      std::equal(mesh.vertices.begin(), mesh.vertices.end(), deformer.positions(0).begin()));
}

}  // namespace
}  // namespace arap::testing
