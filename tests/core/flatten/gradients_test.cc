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
#include "tests/support/must.h"

namespace arap::testing {
namespace {

struct Columns {
  explicit Columns(const std::vector<Complex>& points) {
    for (const Complex p : points) x.push_back(p.real()), y.push_back(p.imag());
  }
  ConstShapeView View() const { return {x.data(), y.data()}; }
  ShapeView Edit() { return {x.data(), y.data()}; }
  double Dot(const Columns& other) const {
    double sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v) sum += x[v] * other.x[v] + y[v] * other.y[v];
    return sum;
  }
  std::vector<double> x, y;
};

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
  Columns pull(uv);
  const double energy = passes.Pull(Columns(uv).View(), pull.Edit(), n);
  EXPECT_NEAR(energy, newton.Energy(uv, 0), 1e-12 * energy);
  const auto step = Must(newton.Direction(uv, 0));
  const std::vector<Complex> move(step.move.begin(), step.move.end());
  EXPECT_NEAR(pull.Dot(Columns(move)), -step.slope, 1e-9 * std::abs(step.slope));
  const auto ahead = passes.Look(Columns(uv).View(), Columns(move).View());
  EXPECT_NEAR(ahead.limit, newton.Limit(uv, move), 1e-9 * ahead.limit);
  const auto noise = Noise(n, 1e-3, 5);
  constexpr double kStep = 1e-4;
  Columns before(uv), after(uv);
  passes.Pull(Columns(Plus(uv, -kStep, noise)).View(), before.Edit(), n);
  passes.Pull(Columns(Plus(uv, kStep, noise)).View(), after.Edit(), n);
  const Columns along(noise);
  const double curvature = (before.Dot(along) - after.Dot(along)) / (2 * kStep);
  EXPECT_NEAR(passes.Look(Columns(uv).View(), along.View()).curvature, curvature,
              1e-5 * std::abs(curvature));
}

TEST(DirichletPassesTest, AFlipCostsWithoutEnd) {
  const SurfaceMesh cap = Cap(4, 8, 0.5);
  std::vector<Complex> uv = Start(cap);
  for (Complex& z : uv) z = std::conj(z);
  Columns pull(uv);
  const double energy = DirichletPasses(cap, {}).Pull(Columns(uv).View(), pull.Edit(), uv.size());
  EXPECT_TRUE(std::isinf(energy));
}

TEST(DirichletPassesTest, PlainAndWideGiveTheSameBytes) {
  const SurfaceMesh cap = Cap(10, 20, 0.9);
  const std::size_t n = cap.vertices.size();
  const Columns at(Start(cap)), along(Noise(n, 1e-2, 7));
  const DirichletPasses plain(cap, {}, false), best(cap, {});
  Columns one = at, two = at;
  EXPECT_EQ(plain.Pull(at.View(), one.Edit(), n), best.Pull(at.View(), two.Edit(), n));
  EXPECT_EQ(one.x, two.x);
  EXPECT_EQ(one.y, two.y);
  const auto a = plain.Look(at.View(), along.View()), b = best.Look(at.View(), along.View());
  EXPECT_EQ(a.limit, b.limit);
  EXPECT_EQ(a.curvature, b.curvature);
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
