// The inverse map, depths, and several frames at once.
#include "arap/core/pick.h"

#include "core/mesh/locate.h"
#include "tests/core/deform/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

std::optional<Pick> PickAt(const CompiledHandles& set, const std::vector<Complex>& shape,
                           Complex point) {
  return Must(FindPicks(set, shape, {&point, 1})).front();
}

TEST(PickTest, TakesADeformedPointBackToRest) {
  PlanarMesh mesh = JitteredGrid(12, 9, 3);
  std::swap(mesh.triangles[17][0], mesh.triangles[17][1]);  // clockwise: it will be turned
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 5, 2));
  const auto shape = Deform(set, RandomTargets(*set, 1, 4));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<double, 3> b{0.5, 0.3, 0.2};
    Complex deformed = 0, rest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      deformed += b[k] * shape[mesh.triangles[t][k]];
      rest += b[k] * mesh.vertices[mesh.triangles[t][k]];
    }
    const auto pick = PickAt(*set, shape, deformed);
    ASSERT_TRUE(pick.has_value());
    EXPECT_LE(pick->triangle, t);  // the lowest, where they overlap
    if (pick->triangle != t) continue;
    EXPECT_LE(std::abs(pick->rest - rest), 1e-9);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(pick->barycentric[k], b[k], 1e-9);
  }
  EXPECT_FALSE(PickAt(*set, shape, {1000, 1000}).has_value());
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
    const auto pick = PickAt(*set, shape, {0.75, 0.25});
    ASSERT_TRUE(pick.has_value());
    EXPECT_EQ(pick->triangle, depth > 0 ? 2u : 0u);
  }
}

// The same, by looking at every triangle in turn.
std::optional<Pick> ScanAt(const CompiledHandles& set, const PlanarMesh& mesh,
                           const std::vector<Complex>& shape, Complex point) {
  const std::span<const double> depths = VertexDepths(set);
  std::optional<Pick> best;
  double highest = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto found = LocateIn(shape, mesh.triangles, t, point);
    if (!found) continue;
    double depth = 0;
    Pick pick{t, found->barycentric, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      if (!depths.empty()) depth += pick.barycentric[k] * depths[v];
      pick.rest += pick.barycentric[k] * mesh.vertices[v];
    }
    if (best && depth <= highest) continue;
    best = pick;
    highest = depth;
  }
  return best;
}

TEST(PickTest, AnswersLikeAScanOfAllTriangles) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const PlanarMesh mesh = TwoComponents(17, 13, seed);
    auto handles = RandomHandles(mesh, 9, seed);
    for (std::size_t i = 0; seed % 2 == 0 && i < handles.size(); ++i) {
      handles[i].depth = i % 3 == 0 ? 1 : static_cast<double>(i) - 5;
      handles[i].depth_falloff = i % 2 == 0 ? 0 : 4;
    }
    const auto set = Compile(Register(mesh), handles);
    // Targets far apart fold the shape over itself.
    const auto shape = Deform(set, RandomTargets(*set, 12, seed));
    std::vector<Complex> points(shape.begin(), shape.begin() + 40);  // vertices lie on edges
    for (const Target& t : RandomTargets(*set, 15, seed + 10)) points.push_back(t.position);
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
      const Triangle& c = mesh.triangles[t];
      points.push_back(0.5 * (shape[c[0]] + shape[c[1]]));
      points.push_back(0.2 * shape[c[0]] + 0.3 * shape[c[1]] + 0.5 * shape[c[2]]);
    }
    const auto picks = Must(FindPicks(*set, shape, points));
    ASSERT_EQ(picks.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(picks[i], ScanAt(*set, mesh, shape, points[i]))
          << "seed " << seed << " point " << i;
    }
  }
}

// A token that cancels when it is asked for the n-th time.
CancelToken CancelAt(int n, int& asked) {
  return CancelToken([n, &asked]() -> Status {
    if (++asked < n) return {};
    return Fail(FaultKind::kCancelled, "The test cancelled it.");
  });
}

TEST(PickTest, CancelsBetweenPoints) {
  const PlanarMesh mesh = JitteredGrid(6, 6, 3);
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 4, 2));
  const std::vector<Complex> points(10, Complex(1, 1));
  int asked = 0;
  const auto picks = FindPicks(*set, mesh.vertices, points, CancelAt(4, asked));
  ASSERT_FALSE(picks.has_value());
  EXPECT_EQ(picks.error().kind, FaultKind::kCancelled);
  EXPECT_EQ(asked, 4);
}

TEST(UpdateTest, CancelsBetweenRefinementsAndKeepsTheShape) {
  const PlanarMesh mesh = JitteredGrid(6, 6, 3);
  for (const std::size_t handles : {4u, 40u}) {
    const auto set = Compile(Register(mesh), RandomHandles(mesh, handles, 2));
    Deformer deformer(set);
    const auto targets = RandomTargets(*set, 2, 5);
    int asked = 0;
    const auto quality = deformer.Update(targets, {DeformMode::kRigid, 1000}, CancelAt(3, asked));
    ASSERT_FALSE(quality.has_value());
    EXPECT_EQ(quality.error().kind, FaultKind::kCancelled);
    EXPECT_EQ(asked, 3);
    EXPECT_TRUE(
        std::equal(mesh.vertices.begin(), mesh.vertices.end(), deformer.positions().begin()));
  }
}

TEST(DepthTest, IsTheSumOfTheHandlesOfAComponent) {
  const PlanarMesh mesh = TwoComponents(9, 7, 2);
  const auto registered = Register(mesh);
  auto handles = RandomHandles(mesh, 12, 3);
  for (std::size_t i = 0; i < handles.size(); ++i) {
    handles[i].depth = static_cast<double>(i % 5) - 2;  // some have none
    handles[i].depth_falloff = i % 3 == 0 ? 0 : 2.5;
  }
  const auto set = Compile(registered, handles);
  const auto depths = VertexDepths(*set);
  ASSERT_EQ(depths.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < depths.size(); ++v) {
    double expected = 0;
    for (const PlacedHandle& placed : set->handles()) {
      // Each component has as many vertices.
      if ((v < depths.size() / 2) != (placed.component == 0)) continue;
      const double reach = placed.handle.depth_falloff;
      const double distance = std::abs(mesh.vertices[v] - placed.rest);
      expected += placed.handle.depth * (reach == 0 ? 1 : std::max(0.0, 1 - distance / reach));
    }
    EXPECT_NEAR(depths[v], expected, 1e-12) << v;
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

TEST(UpdateManyTest, ShapesAreTheSameWhetherMeasuredOrNot) {
  const PlanarMesh mesh = JitteredGrid(12, 12, 3);
  const auto set = Compile(Register(mesh), RandomHandles(mesh, 6, 2));
  Deformer all(set, 3), some(set, 3);
  std::vector<std::vector<Target>> targets;
  for (std::uint64_t i = 0; i < 9; ++i) targets.push_back(RandomTargets(*set, 5, i));
  for (const std::uint32_t every : {0u, 1u, 2u, 3u, 20u}) {
    DeformOptions options;
    options.measure_every = every;
    for (std::size_t first = 0; first < 9; first += 3) {
      const std::vector<std::span<const Target>> frames(
          targets.begin() + static_cast<int>(first), targets.begin() + static_cast<int>(first) + 3);
      std::vector<ShapeQuality> measured(3), qualities(3);
      ASSERT_TRUE(all.UpdateMany(frames, {}, measured).has_value());
      ASSERT_TRUE(some.UpdateMany(frames, options, qualities, {}, first).has_value());
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(std::equal(all.positions(i).begin(), all.positions(i).end(),
                               some.positions(i).begin()));
        ASSERT_TRUE(measured[i].measured);
        ASSERT_EQ(qualities[i].measured, every > 0 && (first + i) % every == 0);
        if (qualities[i].measured) {
          EXPECT_EQ(qualities[i], measured[i]);
          continue;
        }
        ShapeQuality handles_alone;
        handles_alone.measured = false;
        handles_alone.worst_handle = measured[i].worst_handle;
        handles_alone.worst_handle_error = measured[i].worst_handle_error;
        EXPECT_EQ(qualities[i], handles_alone);
      }
    }
    const ShapeQuality one = Must(some.Update(targets[1], options));
    EXPECT_EQ(one.measured, every > 0);
    EXPECT_GT(one.worst_handle_error, 0);
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
