// The dense local/global iteration: fixed points, descent, and its energy in closed form.
#include "tests/support/dense_arap.h"

#include <gtest/gtest.h>

#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

TEST(DenseArap, RigidMotionIsAFixedPointWithoutEnergy) {
  const PlanarMesh mesh = JitteredGrid(5, 4, 1);
  const auto handles = RandomInnerHandles(mesh, 3, 2);
  const RigidMotion motion{-1.1, Complex(5, 6)};
  const auto moved = Apply(motion, mesh.vertices);
  const DenseArapResult result =
      DenseArap(CellsOf(mesh), handles, Apply(motion, RestTargets(mesh, handles)), moved, 3);
  EXPECT_LT(RelativeDistance(result.positions, moved), 1e-8);
  EXPECT_LT(result.total_energy, 1e-12);
}

TEST(DenseArap, EveryIterationLowersTheEnergy) {
  const PlanarMesh mesh = JitteredGrid(6, 6, 3);
  const auto handles = RandomVertexHandles(mesh, 4, 4);
  const auto targets = RandomPose(mesh, RestTargets(mesh, handles), 0.3, 5);
  std::vector<Complex> shape = TextbookDeform(mesh, true, Weights::kCotangent, handles, targets);
  double before = DenseArap(CellsOf(mesh), handles, targets, shape, 1).total_energy;
  for (int iterations = 2; iterations < 12; ++iterations) {
    const double after = DenseArap(CellsOf(mesh), handles, targets, shape, iterations).total_energy;
    EXPECT_LE(after, before * (1 + 1e-9));
    before = after;
  }
}

TEST(DenseArap, EnergyOfAUniformStretchIsKnown) {
  // Cotangent weights make the energy of a linear map area·((s1−1)² + (s2−1)²).
  const PlanarMesh mesh = JitteredGrid(3, 3, 6);
  double area = 0;
  for (const Triangle& t : mesh.triangles) area += SignedArea(t, mesh.vertices);
  std::vector<Complex> stretched;
  for (const Complex& v : mesh.vertices) stretched.emplace_back(1.5 * v.real(), 0.8 * v.imag());
  EXPECT_NEAR(FaceEnergy(CellsOf(mesh), stretched), area * (0.25 + 0.04), 1e-10);
}

TEST(DenseArap, FlattensADevelopableWithoutHandles) {
  const Developable sheet = RolledSheet(6, 4, 6, 4, 0.7, 7);
  // From a disturbed start back to the isometry.
  std::vector<Complex> start = sheet.flat;
  for (std::size_t v = 0; v < start.size(); ++v) start[v] *= v % 2 == 0 ? 1.02 : 0.98;
  const DenseArapResult result = DenseArap(CellsOf(sheet.surface), {}, {}, start, 200);
  EXPECT_LT(RelativeDistanceUpToMotion(result.positions, sheet.flat), 1e-6);
}

}  // namespace
}  // namespace arap::testing
