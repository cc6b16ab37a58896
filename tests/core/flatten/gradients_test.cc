// The descent without a Hessian, what it asks of the energy, and flips that are mended where they
// are.
#include "core/flatten/injective/gradients.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/flatten/distortion.h"
#include "core/flatten/injective/dirichlet.h"
#include "core/flatten/injective/injective.h"
#include "core/flatten/injective/newton_descent.h"
#include "core/flatten/injective/patches.h"
#include "core/flatten/injective/tutte.h"
#include "tests/core/flatten/injective_fixture.h"
#include "tests/support/meshes.h"
#include "tests/support/must.h"

namespace arap::testing {
namespace {

double Dot(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v) sum += (std::conj(a[v]) * b[v]).real();
  return sum;
}

std::vector<Complex> Start(const SurfaceMesh& mesh) {
  auto uv = Must(TutteEmbedding(mesh, WalkLoops(mesh), TutteWeights::kUniform));
  const double scale = Newton::Make(mesh, {}, {}).BestScale(uv);
  for (Complex& z : uv) z *= scale;
  return uv;
}

std::vector<Complex> Plus(std::vector<Complex> uv, double t, const std::vector<Complex>& move) {
  for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += t * move[v];
  return uv;
}

TEST(DirichletPassesTest, AgreeWithNewtonAndWithDifferences) {
  const SurfaceMesh cap = Cap(10, 20, 0.6);
  const std::size_t n = cap.vertices.size();
  const std::vector<Complex> uv = Start(cap);
  const DirichletPasses passes(cap, {});
  Newton newton = Newton::Make(cap, {}, {});
  std::vector<Complex> pull(n);
  const double energy = passes.Pull(uv, pull);
  EXPECT_NEAR(energy, newton.Energy(uv, 0), 1e-12 * energy);
  const auto step = Must(newton.Direction(uv, 0));
  const std::vector<Complex> move(step.move.begin(), step.move.end());
  EXPECT_NEAR(Dot(pull, move), -step.slope, 1e-9 * std::abs(step.slope));
  const auto ahead = passes.Look(uv, move);
  EXPECT_NEAR(ahead.limit, newton.Limit(uv, move), 1e-9 * ahead.limit);
  const auto noise = Noise(n, 1e-3, 5);
  constexpr double kStep = 1e-4;
  std::vector<Complex> before(n), after(n);
  passes.Pull(Plus(uv, -kStep, noise), before);
  passes.Pull(Plus(uv, kStep, noise), after);
  const double curvature = (Dot(before, noise) - Dot(after, noise)) / (2 * kStep);
  EXPECT_NEAR(passes.Look(uv, noise).curvature, curvature, 1e-5 * std::abs(curvature));
}

TEST(DirichletPassesTest, AFlipCostsWithoutEnd) {
  const SurfaceMesh cap = Cap(4, 8, 0.5);
  std::vector<Complex> uv = Start(cap), pull(uv.size());
  EXPECT_TRUE(std::isfinite(DirichletPasses(cap, {}).Pull(uv, pull)));
  // So does a triangle that is upright by no more than rounding, wherever it is in its block.
  for (std::size_t t = 0; t < cap.triangles.size(); ++t) {
    std::vector<Complex> flat = uv;
    const auto& [a, b, c] = cap.triangles[t];
    flat[a] = 0.5 * (uv[b] + uv[c]);
    const bool upright = NotUpright(cap.triangles, flat).empty();
    EXPECT_EQ(std::isinf(DirichletPasses(cap, {}).Pull(flat, pull)), !upright) << t;
  }
  for (Complex& z : uv) z = std::conj(z);
  EXPECT_TRUE(std::isinf(DirichletPasses(cap, {}).Pull(uv, pull)));
}

TEST(DirichletPassesTest, NothingCancelsNearAnIsometry) {
  // Lengths of a flat surface that grow by a part of 1e-7: of the energy of 4 each triangle has 8e-14
  // more, which 4 − 4 would lose.
  const PlanarMesh square = Grid(6, 6, 1, 1);
  SurfaceMesh flat;
  for (const Complex p : square.vertices) flat.vertices.push_back({p.real(), p.imag(), 0});
  flat.triangles = square.triangles;
  std::vector<Complex> uv = square.vertices, pull(uv.size());
  const DirichletPasses passes(flat, {});
  EXPECT_LT(passes.Pull(uv, pull), 1e-28);
  for (Complex& z : uv) z *= 1 + 1e-7;
  EXPECT_NEAR(passes.Pull(uv, pull), 8e-14, 1e-19);
}

TEST(DirichletPassesTest, AllMachineCodesGiveTheSameBytes) {
  for (const std::size_t sectors : {7u, 20u}) {
    const SurfaceMesh cap = Cap(10, sectors, 0.9);
    const std::size_t n = cap.vertices.size();
    const std::vector<Complex> uv = Start(cap), along = Noise(n, 1e-2, 7);
    const DirichletPasses plain(cap, {}, DirichletKernelsHere().front());
    std::vector<Complex> wanted(n), pull(n);
    const double energy = plain.Pull(uv, wanted);
    const auto ahead = plain.Look(uv, along);
    for (const DirichletKernels& kernels : DirichletKernelsHere()) {
      const DirichletPasses passes(cap, {}, kernels);
      EXPECT_EQ(passes.Pull(uv, pull), energy);
      EXPECT_EQ(pull, wanted);
      EXPECT_EQ(passes.Look(uv, along).limit, ahead.limit);
      EXPECT_EQ(passes.Look(uv, along).curvature, ahead.curvature);
    }
  }
}

TEST(DirichletPassesTest, TheMatrixKnowsInWhichDirectionATriangleIsStretched) {
  const PlanarMesh square = Grid(4, 4, 1, 1);
  SurfaceMesh flat;
  for (const Complex p : square.vertices) flat.vertices.push_back({p.real(), p.imag(), 0});
  flat.triangles = square.triangles;
  DirichletPasses passes(flat, {});
  const std::size_t n = flat.vertices.size();
  auto lower = passes.Pattern(n);
  const auto bend = [&](const std::vector<Complex>& move) {
    double sum = 0;
    for (int j = 0; j < lower.outerSize(); ++j) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(lower, j); it; ++it) {
        const auto a = static_cast<std::size_t>(it.row()), b = static_cast<std::size_t>(j);
        sum += (a == b ? 1 : 2) * it.value() * (std::conj(move[a]) * move[b]).real();
      }
    }
    return sum;
  };
  std::vector<Complex> uv = square.vertices, wide(n), high(n), across(n);
  for (std::size_t v = 0; v < n; ++v) {
    wide[v] = square.vertices[v].real();
    high[v] = Complex(0, square.vertices[v].imag());
    across[v] = Complex(0, square.vertices[v].real());
    uv[v] = Complex(2 * uv[v].real(), 0.5 * uv[v].imag());
  }
  passes.Fill(uv, lower);
  // s1 = 2, s2 = 1/2: second derivatives of 2 + 6/16 and 2 + 6·16 along them; across them a quarter of the
  // shear, 4 (1 + 5.25), and of the twist, which is negative.
  const double turned = 0.25 * 25;
  EXPECT_NEAR(bend(wide), 0.5 * (2.375 + turned), 1e-12);
  EXPECT_NEAR(bend(across), bend(wide), 1e-12);
  EXPECT_NEAR(bend(high), 0.5 * (98 + turned), 1e-11);
  passes.Fill({}, lower);
  EXPECT_NEAR(bend(wide), 6, 1e-12);
  EXPECT_NEAR(bend(high), 6, 1e-12);
}

TEST(GradientsTest, EndWhereNewtonEnds) {
  const SurfaceMesh cap = Cap(16, 32, 0.8);
  const std::vector<Complex> start = Start(cap);
  const auto last = static_cast<std::uint32_t>(cap.vertices.size() - 1);
  const std::vector<std::vector<LayoutPin>> cases{
      {},
      {{0, start[0] + Complex(0.1, 0.05), 10}, {last, start[last] * 1.1, 1}},
      {{0, start[0], kHard}, {last, start[last], kHard}}};
  for (const auto& pins : cases) {
    std::vector<Complex> uv = start, wanted = start;
    Newton newton = Newton::Make(cap, pins, {});
    const std::vector<bool> none;
    int steps = 0;
    ASSERT_TRUE(Descend({newton, cap.triangles, none, {}}, 1e-8, 200, wanted, steps));
    const auto result = Must(DescendGradients(cap, {300, 1e-7, pins, none}, {}, uv));
    EXPECT_TRUE(result.converged) << pins.size();
    const double least = newton.Energy(wanted, 0);
    EXPECT_LE(newton.Energy(uv, 0), (1 + 1e-5) * least) << pins.size();
    EXPECT_TRUE(NotUpright(cap.triangles, uv).empty());
    for (const LayoutPin& pin : pins) {
      if (!std::isinf(pin.weight)) continue;
      EXPECT_EQ(uv[pin.vertex], pin.uv);
    }
    std::vector<Complex> again = start;
    ASSERT_TRUE(DescendGradients(cap, {300, 1e-7, pins, none}, {}, again));
    EXPECT_EQ(again, uv);
  }
}

TEST(PatchesTest, MendFewFlipsWhereTheyAre) {
  const SurfaceMesh cap = Cap(16, 32, 0.8);
  const std::vector<Complex> start = Start(cap);
  const Triangle& t = cap.triangles[cap.triangles.size() / 2];
  std::vector<Complex> uv = start;
  uv[t[0]] += 1.5 * (start[t[1]] + start[t[2]] - 2.0 * start[t[0]]);
  const auto flipped = NotUpright(cap.triangles, uv);
  ASSERT_FALSE(flipped.empty()) << "else this tests nothing";
  int steps = 0;
  EXPECT_TRUE(Must(MendPatches(cap, {}, {}, {}, uv, steps)));
  EXPECT_GT(steps, 0);
  EXPECT_TRUE(NotUpright(cap.triangles, uv).empty());
  std::size_t moved = 0;
  for (std::size_t v = 0; v < uv.size(); ++v) {
    if (uv[v] != start[v]) ++moved;
  }
  EXPECT_LT(moved, uv.size() / 4);
}

TEST(PatchesTest, LeaveManyFlipsAndNone) {
  const SurfaceMesh cap = Cap(8, 16, 0.5);
  const std::vector<Complex> start = Start(cap);
  std::vector<Complex> uv = start;
  int steps = 0;
  EXPECT_FALSE(Must(MendPatches(cap, {}, {}, {}, uv, steps)));
  EXPECT_EQ(uv, start);
  for (Complex& z : uv) z = std::conj(z);
  const std::vector<Complex> turned = uv;
  EXPECT_FALSE(Must(MendPatches(cap, {}, {}, {}, uv, steps)));
  EXPECT_EQ(uv, turned);
  EXPECT_EQ(steps, 0);
}

}  // namespace
}  // namespace arap::testing
