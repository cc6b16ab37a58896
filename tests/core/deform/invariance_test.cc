// What a deformation must not depend on, and what it must follow.

#include "tests/core/deform/fixture.h"
#include "tests/support/bounded.h"
#include "tests/support/compare.h"
#include "tests/support/dense_arap.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

const Basis kAllBases[] = {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace, Basis::kVertex};
const Weights kAllWeights[] = {Weights::kUniform, Weights::kCotangent};

TEST(InvarianceTest, TheRestPoseIsAFixedPoint) {
  for (const PlanarMesh& mesh : {JitteredGrid(12, 9, 1), Annulus(3, 20, 1, 2), Strip(30),
                                 SingleTriangle(), TwoComponents(6, 6, 2)}) {
    for (const Basis basis : kAllBases) {
      for (const Weights weights : kAllWeights) {
        const auto count = std::min<std::size_t>(5, mesh.triangles.size());
        auto handles = RandomHandles(mesh, count, 3);
        if (count == 1) handles = {OnVertex("a", 0), OnVertex("b", 1)};
        const auto set = Compile(Register(mesh, basis, weights), handles);
        ShapeQuality quality;
        EXPECT_LE(
            RelativeDistance(Deform(set, set->RestTargets(), {DeformMode::kRigid, 2}, &quality),
                             mesh.vertices),
            1e-12);
        EXPECT_LE(quality.energy, 1e-24);
        EXPECT_EQ(quality.flipped, 0u);
        EXPECT_NEAR(quality.mean_stretch, 1, 1e-9);
      }
    }
  }
}

// Moving mesh and targets by one similarity moves the shape by it.
TEST(InvarianceTest, SimilarityEquivariance) {
  const Complex factor = std::polar(37.0, 2.5), shift(-500, 80);
  const PlanarMesh mesh = JitteredGrid(14, 10, 5);
  const auto handles = RandomHandles(mesh, 6, 6);
  for (const Basis basis : kAllBases) {
    for (const Weights weights : kAllWeights) {
      const auto set = Compile(Register(mesh, basis, weights), handles);
      const auto moved_set = Compile(Register(Moved(mesh, factor, shift), basis, weights), handles);
      auto targets = RandomTargets(*set, 4, 7);
      std::vector<Complex> expected = Deform(set, targets);
      for (Complex& p : expected) p = factor * p + shift;
      for (Target& t : targets) t.position = factor * t.position + shift;
      EXPECT_LE(RelativeDistance(Deform(moved_set, targets), expected), 1e-10);
    }
  }
}

// Turning the targets alone turns the shape: the energy knows no direction.
TEST(InvarianceTest, RigidEquivarianceOfTheTargets) {
  const PlanarMesh mesh = JitteredGrid(14, 10, 5);
  const RigidMotion motion{1.9, {40, -7}};
  for (const Basis basis : kAllBases) {
    const auto set = Compile(Register(mesh, basis), RandomHandles(mesh, 6, 6));
    auto targets = RandomTargets(*set, 4, 7);
    const auto expected = Apply(motion, Deform(set, targets));
    for (Target& t : targets) t.position = motion(t.position);
    EXPECT_LE(RelativeDistance(Deform(set, targets), expected), 1e-11);
  }
}

TEST(InvarianceTest, NumberingDoesNotMatterExceptAsPublished) {
  const PlanarMesh mesh = JitteredGrid(14, 10, 5);
  const auto handles = RandomHandles(mesh, 6, 6);
  const RenumberedMesh renumbered = Renumbered(mesh, 9);
  for (const Basis basis : kAllBases) {
    for (const Weights weights : kAllWeights) {
      const auto set = Compile(Register(mesh, basis, weights), handles);
      std::vector<Handle> same_places;
      for (std::size_t i = 0; i < handles.size(); ++i) {
        Handle h = handles[i];
        h.anchor = PointAnchor{set->handles()[i].rest};
        same_places.push_back(h);
      }
      const auto other = Compile(Register(renumbered.mesh, basis, weights), same_places);
      const auto targets = RandomTargets(*set, 4, 7);
      const auto shape = Deform(set, targets), renumbered_shape = Deform(other, targets);
      std::vector<Complex> back(shape.size());
      for (std::size_t v = 0; v < back.size(); ++v) {
        back[v] = renumbered_shape[renumbered.new_vertex[v]];
      }
      if (basis == Basis::kEdgeAsPublished) {
        EXPECT_GT(RelativeDistance(back, shape), 1e-4) << "the published variant depends on it";
      } else {
        EXPECT_LE(RelativeDistance(back, shape), 1e-9);
      }
    }
  }
}

TEST(InvarianceTest, SoftHandlesBecomeHardOnesAsTheirWeightGrows) {
  const PlanarMesh mesh = JitteredGrid(14, 10, 5);
  const auto registered = Register(mesh);
  auto handles = RandomHandles(mesh, 6, 6);
  for (Handle& h : handles) h.hard = true;
  const auto hard = Compile(registered, handles);
  const auto targets = RandomTargets(*hard, 4, 7);
  const auto expected = Deform(hard, targets);
  double last = 1;
  for (const double weight : {1e2, 1e4, 1e6, 1e8}) {
    for (Handle& h : handles) h.hard = false, h.weight = weight;
    const double distance =
        RelativeDistance(Deform(Compile(registered, handles), targets), expected);
    EXPECT_LE(distance, 0.05 * last) << weight;  // first order in 1/weight
    last = distance;
  }
  EXPECT_LE(last, 1e-6);
}

TEST(InvarianceTest, RefiningNeverRaisesTheEnergyOfFaceAndVertexCells) {
  const PlanarMesh mesh = JitteredGrid(14, 10, 5);
  for (const Basis basis : {Basis::kFace, Basis::kVertex}) {
    for (const Weights weights : kAllWeights) {
      auto handles = RandomHandles(mesh, 6, 6);
      for (Handle& h : handles) h.hard = true;  // so that the energy is all there is
      const auto set = Compile(Register(mesh, basis, weights), handles);
      for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        const auto targets = RandomTargets(*set, 5, seed);
        double last = 1e300;
        for (int refine = 0; refine < 40; ++refine) {
          ShapeQuality quality;
          Deform(set, targets, {DeformMode::kRigid, refine}, &quality);
          EXPECT_LE(quality.energy, last * (1 + 1e-12)) << "refine " << refine;
          last = quality.energy;
        }
      }
    }
  }
}

TEST(InvarianceTest, RefinedFaceCellsAreTheDenseLocalGlobalIteration) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    const PlanarMesh mesh = JitteredGrid(7, 6, seed);
    const auto handles = RandomHandles(mesh, 4, seed);
    const auto set = Compile(Register(mesh, Basis::kFace, Weights::kCotangent), handles);
    const auto targets = RandomTargets(*set, 1.5, seed);
    std::vector<TextbookHandle> rows;
    std::vector<Complex> points;
    for (std::size_t i = 0; i < handles.size(); ++i) {
      const auto& anchor = std::get<TriangleAnchor>(handles[i].anchor);
      rows.push_back({mesh.triangles[anchor.triangle], anchor.barycentric, handles[i].weight});
      points.push_back(targets[i].position);
    }
    const auto start = Deform(set, targets);
    const DenseArapResult dense = DenseArap(CellsOf(mesh), rows, points, start, 200);
    ShapeQuality quality;
    const auto shape = Deform(set, targets, {DeformMode::kRigid, 200}, &quality);
    const double diagonal = Diagonal(mesh.vertices);
    EXPECT_NEAR(quality.energy * diagonal * diagonal, dense.energy, 1e-6 * dense.energy) << seed;
    EXPECT_LE(RelativeDistance(shape, dense.positions), 1e-6) << seed;
  }
}

TEST(InvarianceTest, SameTargetsGiveTheSameBytesWhateverCameBefore) {
  const PlanarMesh mesh = JitteredGrid(20, 20, 5);
  for (const std::size_t count : {6u, 80u}) {
    const auto set = Compile(Register(mesh), RandomHandles(mesh, count, 6));
    const auto targets = RandomTargets(*set, 4, 7);
    const auto expected = Deform(set, targets);
    std::vector<std::vector<Complex>> answers(4);
    std::vector<BoundedThread> threads;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      threads.emplace_back("a thread that deforms", [&, i] {
        Deformer deformer(set);
        for (std::uint64_t before = 0; before < 5 + i; ++before) {
          (void)deformer.Update(RandomTargets(*set, 50, before));
        }
        (void)deformer.Update(targets);
        answers[i].assign(deformer.positions().begin(), deformer.positions().end());
      });
    }
    threads.clear();
    for (const auto& answer : answers) EXPECT_EQ(answer, expected);
  }
}

TEST(InvarianceTest, StarchedTrianglesKeepTheirShape) {
  const PlanarMesh mesh = Grid(20, 4, 20, 4);
  std::vector<double> rigidity(mesh.triangles.size(), 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Complex p = mesh.vertices[mesh.triangles[t][0]];
    if (p.real() >= 8 && p.real() < 12) rigidity[t] = 1e4;
  }
  for (const Basis basis : kAllBases) {
    double stretched[2];
    for (const bool starch : {false, true}) {
      const auto set = Compile(
          Register(mesh, basis, Weights::kUniform, starch ? rigidity : std::vector<double>{}),
          {OnVertex("left", 42), OnVertex("right", 62)});
      auto targets = set->RestTargets();
      targets[1].position += 10.0;
      const auto shape = Deform(set, targets);
      stretched[starch] = std::abs(shape[54] - shape[50]) / 4;  // from x = 8 to x = 12
    }
    EXPECT_GT(stretched[0], 1.2) << static_cast<int>(basis);
    EXPECT_NEAR(stretched[1], 1, 0.01) << static_cast<int>(basis);
  }
}

}  // namespace
}  // namespace arap::testing
