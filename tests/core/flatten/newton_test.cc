// What injective layouts are made of: the energies and their derivatives, the Newton step and how
// far it may go, the test of a triangle, the start.
#include "core/flatten/injective/newton.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/flatten/distortion.h"
#include "core/flatten/injective/tutte.h"
#include "tests/core/flatten/injective_fixture.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

// ---- Energies

template <class Value, class Derivatives>
void ExpectDerivatives(double a, double b, Value value, Derivatives derivatives) {
  const Density d = derivatives(a, b);
  const double h = 1e-4 * std::min(1.0, std::max(a, b));
  const double da = (value(a + h, b) - value(a - h, b)) / (2 * h);
  const double db = (value(a, b + h) - value(a, b - h)) / (2 * h);
  const double size = std::abs(value(a, b)) + 1;
  EXPECT_NEAR(d.twist * a, da, 1e-5 * size) << a << ' ' << b;
  EXPECT_NEAR(d.shear * b, db, 1e-5 * size) << a << ' ' << b;
  const double mid = value(a, b);
  EXPECT_NEAR(d.aa, (value(a + h, b) - 2 * mid + value(a - h, b)) / (h * h), 1e-3 * size);
  EXPECT_NEAR(d.bb, (value(a, b + h) - 2 * mid + value(a, b - h)) / (h * h), 1e-3 * size);
  EXPECT_NEAR(
      d.ab,
      (value(a + h, b + h) - value(a + h, b - h) - value(a - h, b + h) + value(a - h, b - h)) /
          (4 * h * h),
      1e-3 * size);
}

TEST(EnergyDensityTest, HasTheDerivativesOfItsValue) {
  for (const auto& [a, b] : {std::pair{1.0, 0.2}, {2.0, 1.2}, {0.9, 0.05}, {1.4, 0.7}}) {
    ExpectDerivatives(a, b, SymmetricDirichlet, SymmetricDirichletDensity);
  }
  for (const double epsilon : {0.5, 1.0}) {
    for (const auto& [a, b] : {std::pair{1.0, 0.2}, {0.5, 0.9}, {0.7, 0.7}, {1.5, 0.3}}) {
      ExpectDerivatives(
          a, b, [&](double x, double y) { return Untangling(x, y, epsilon); },
          [&](double x, double y) { return UntanglingDensity(x, y, epsilon); });
    }
  }
}

TEST(EnergyDensityTest, IsLeastAtAnIsometryAndInfiniteAtACollapse) {
  EXPECT_EQ(SymmetricDirichlet(1, 0), 0);
  EXPECT_NEAR(SymmetricDirichlet(1 + 1e-9, 0), 8e-18, 1e-23);  // no cancellation
  EXPECT_TRUE(std::isinf(SymmetricDirichlet(0.5, 0.5)));
  EXPECT_TRUE(std::isinf(SymmetricDirichlet(0.5, 0.6)));
  // s1 = 2, s2 = 1/2: 4 + 1/4 + 1/4 + 4, less 4.
  EXPECT_NEAR(SymmetricDirichlet(1.25, 0.75), 4.5, 1e-14);
  EXPECT_NEAR(Untangling(1, 0, 1e-9), 0, 1e-12);
  EXPECT_TRUE(std::isfinite(Untangling(0, 1, 1e-3)));
}

TEST(NewtonTest, SlopeIsThatOfTheEnergyAlongTheStep) {
  const PlanarMesh plane = JitteredGrid(6, 5, 3);
  const SurfaceMesh mesh = Lifted(plane);
  std::vector<Complex> uv = From(plane, 1 / 8.0);
  const auto noise = Noise(uv.size(), 0.01, 5);
  for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += noise[v];
  const std::vector<LayoutPin> pins{{3, {0.1, 0.4}, 0.7}, {8, uv[8], kHard}};
  auto newton = Newton::Make(mesh, pins, {});
  for (const double epsilon : {0.0, 0.3}) {
    const auto step = newton.Direction(uv, epsilon);
    ASSERT_TRUE(step.has_value());
    EXPECT_EQ(step->move[8], Complex(0));
    EXPECT_LT(step->slope, 0);
    const double h = 1e-6;
    std::vector<Complex> ahead = uv, behind = uv;
    for (std::size_t v = 0; v < uv.size(); ++v) {
      ahead[v] += h * step->move[v];
      behind[v] -= h * step->move[v];
    }
    const double slope = (newton.Energy(ahead, epsilon) - newton.Energy(behind, epsilon)) / (2 * h);
    EXPECT_NEAR(step->slope, slope, 1e-6 * std::abs(slope));
  }
}

TEST(NewtonTest, ConvergesQuadraticallyToAnIsometry) {
  const Developable made = Accordion(8, 6, 4, 1, 2.4, 2);
  auto newton = Newton::Make(made.surface, {}, {});
  std::vector<Complex> uv = made.flat;
  const auto noise = Noise(uv.size(), 1e-4, 7);
  for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += noise[v];
  double energy = newton.Energy(uv, 0);
  for (int i = 0; i < 2; ++i) {
    const auto step = newton.Direction(uv, 0);
    ASSERT_TRUE(step.has_value());
    for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += step->move[v];
    const double next = newton.Energy(uv, 0);
    EXPECT_LT(next, 1e-3 * energy);
    energy = next;
  }
}

TEST(NewtonTest, LimitIsWhereTheFirstTriangleCollapses) {
  const PlanarMesh plane = JitteredGrid(6, 5, 4);
  const SurfaceMesh mesh = Lifted(plane);
  auto newton = Newton::Make(mesh, {}, {});
  const auto move = Noise(plane.vertices.size(), 1, 6);
  const double limit = newton.Limit(plane.vertices, move);
  ASSERT_TRUE(limit > 0 && std::isfinite(limit));
  const auto at = [&](double t) {
    std::vector<Complex> uv = plane.vertices;
    for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += t * move[v];
    return newton.LeastDeterminant(uv);
  };
  EXPECT_GT(at(0.5 * limit), 0);
  EXPECT_GT(at((1 - 1e-6) * limit), 0);
  EXPECT_LT(at((1 + 1e-6) * limit), 0);
  const std::vector<Complex> still(move.size(), Complex(1, 2));
  EXPECT_TRUE(std::isinf(newton.Limit(plane.vertices, still)));
}

// ---- Upright

TEST(UprightTest, NeedsAnAreaBeyondRounding) {
  EXPECT_TRUE(Upright({0, 0}, {1, 0}, {0, 1}));
  EXPECT_FALSE(Upright({0, 0}, {0, 1}, {1, 0}));
  EXPECT_FALSE(Upright({0, 0}, {1, 1}, {2, 2}));
  EXPECT_TRUE(Upright({0, 0}, {1, 0}, {0, 1e-12}));
  EXPECT_FALSE(Upright({1, 1}, {2, 1}, {1, 1 + 2e-16}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Upright({0, 0}, {1, 0}, {0, nan}));
  EXPECT_FALSE(Upright({0, 0}, {1, 0}, {0, kHard}));
}

TEST(UprightTest, SeesAVertexThatIsWoundTwice) {
  // Twelve triangles round vertex 0; each spans 30° or, the second time, 60° of the plane.
  std::vector<Triangle> fan;
  for (std::uint32_t k = 0; k < 12; ++k) fan.push_back({0, 1 + k, 1 + (k + 1) % 12});
  std::vector<bool> boundary(13, true);
  boundary[0] = false;
  for (const int turns : {1, 2}) {
    std::vector<Complex> uv{0};
    for (int k = 0; k < 12; ++k) uv.push_back(std::polar(1.0, turns * k * std::numbers::pi / 6));
    EXPECT_TRUE(NotUpright(fan, uv).empty());
    EXPECT_EQ(WoundTwice(fan, uv, boundary).size(), turns == 1 ? 0u : 1u);
    // Neighbours that lie exactly beside it are above it.
    for (Complex& z : uv) z = {std::round(4 * z.real()), std::round(4 * z.imag())};
    EXPECT_TRUE(NotUpright(fan, uv).empty());
    EXPECT_EQ(WoundTwice(fan, uv, boundary).size(), turns == 1 ? 0u : 1u);
  }
}

// ---- The start

TEST(TutteTest, LaysEveryDiskAndRingOut) {
  for (const SurfaceMesh& mesh :
       {Lifted(SingleTriangle()), Lifted(Strip(9)), Lifted(JitteredGrid(9, 7, 2)),
        Lifted(Annulus(4, 20, 1, 3)), Cap(12, 24, 0.95)}) {
    for (const TutteWeights weights : {TutteWeights::kUniform, TutteWeights::kCotangent}) {
      const auto uv = TutteEmbedding(mesh, WalkLoops(mesh), weights);
      ASSERT_TRUE(uv.has_value());
      EXPECT_TRUE(NotUpright(mesh.triangles, *uv).empty());
      for (const Complex z : *uv) EXPECT_LE(std::abs(z), 1 + 1e-12);
    }
  }
}

}  // namespace
}  // namespace arap::testing
