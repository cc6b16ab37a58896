// Refinement: the energy that it descends, how fast, and how it ends.
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/energy/assemble.h"
#include "core/energy/local_step.h"
#include "core/energy/rigid_descent.h"
#include "core/flatten/distortion.h"
#include "core/flatten/layout/first_step.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/layout/local_global.h"
#include "tests/core/flatten/fixture.h"
#include "tests/support/dense_arap.h"
#include "tests/support/hard_surfaces.h"
#include "tests/support/obj.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

// Two squares that touch in one vertex, so that a weld is among the cells, a cell or two each way.
SurfaceMesh Touching() {
  SurfaceMesh mesh = SphereCap(3, 8, 1.2);
  const auto joint = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  const auto next = joint + 1;
  const Point3 at = mesh.vertices[joint];
  mesh.vertices.push_back({at[0] + 1, at[1] - 0.4, at[2]});
  mesh.vertices.push_back({at[0] + 1, at[1] + 0.6, at[2] + 0.1});
  mesh.triangles.push_back({joint, next, next + 1});
  return mesh;
}

// One chart with its FACE cells, and its first step from the centre edge.
struct Case {
  explicit Case(const SurfaceMesh& mesh, bool cut = false) {
    CutOptions options;
    options.auto_cut = cut;
    CutSurface surface = Must(CutToCharts(mesh, options, {}, {}));
    charts = Must(MakeCharts(surface));
    EXPECT_EQ(charts.size(), 1u);
    cells = Must(chart().Cells({Basis::kFace, Weights::kCotangent, {}})).cells;
    ground = chart().centre;
    held = HoldAtDistance(chart(), ground);
    system = std::make_unique<GroundedSystem<Complex>>(Must(HeldSystem(cells, held, n())));
    first = Must(HeldFirstStep(*system, held, n()));
    auto factor = Must(RigidSystem(cells, {}, ground[0], n(), system->order()));
    solver =
        FactoredRigidSolver(std::make_shared<const GroundedSystem<double>>(std::move(factor)), {});
  }
  const Chart& chart() const { return charts.front(); }
  std::size_t n() const { return chart().mesh.vertices.size(); }

  LocalGlobalResult Refine(const LocalGlobalOptions& options, std::vector<Complex>& uv) const {
    return Must(LocalGlobal(cells, {}, *solver, options, {}, uv));
  }
  double Energy(const std::vector<Complex>& uv) const { return RigidEnergy(cells, uv); }

  std::vector<Chart> charts;
  Cells cells;
  std::array<std::uint32_t, 2> ground{};
  Held held;
  std::unique_ptr<GroundedSystem<Complex>> system;
  std::vector<Complex> first;
  std::unique_ptr<const RigidSolver> solver;
};

struct Shape {
  explicit Shape(std::size_t n) : x(n), y(n) {}
  Shape(std::size_t n, double size, std::uint64_t seed) : x(n), y(n) {
    Random random(seed);
    for (std::size_t v = 0; v < n; ++v) {
      x[v] = random.Uniform(-size, size);
      y[v] = random.Uniform(-size, size);
    }
  }
  ConstShapeView View() const { return {x.data(), y.data()}; }
  std::vector<Complex> Points() const {
    std::vector<Complex> points;
    for (std::size_t v = 0; v < x.size(); ++v) points.emplace_back(x[v], y[v]);
    return points;
  }
  ShapeView Edit() { return {x.data(), y.data()}; }
  Shape Plus(double t, const Shape& d) const {
    Shape sum = *this;
    for (std::size_t v = 0; v < x.size(); ++v) sum.x[v] += t * d.x[v], sum.y[v] += t * d.y[v];
    return sum;
  }
  double Dot(const Shape& other) const {
    double sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v) sum += x[v] * other.x[v] + y[v] * other.y[v];
    return sum;
  }
  std::vector<double> x, y;
};

TEST(RigidDescentTest, HasTheDerivativesOfTheEnergy) {
  for (const SurfaceMesh& mesh : {SphereCap(4, 9, 1.4), Touching()}) {
    const std::size_t n = mesh.vertices.size();
    const Topology topology = BuildTopology(n, mesh.triangles);
    std::vector<std::array<Complex, 3>> frames;
    for (const Triangle& t : mesh.triangles) frames.push_back(LayFlat(mesh, t));
    const Cells cells = Must(BuildCells(
                                 mesh.triangles, topology, {Basis::kFace, Weights::kCotangent, {}},
                                 [&](std::uint32_t t) { return frames[t]; }, false))
                            .cells;
    const auto matrix = AssembleRigid(cells, std::vector<bool>(n, false));
    const auto square = [&](const Shape& d) {
      double sum = 0;
      for (const auto* part : {&d.x, &d.y}) {
        const Eigen::Map<const Eigen::VectorXd> p(part->data(), static_cast<Eigen::Index>(n));
        sum += p.dot(matrix.selfadjointView<Eigen::Lower>() * p);
      }
      return sum;
    };
    const Shape at(n, 1, 1), along(n, 1, 2);
    RigidDescent descent(cells);
    Shape pull(n), scratch(n);
    const double energy = descent.Pull(at.View(), pull.Edit(), n);
    EXPECT_NEAR(energy, RigidEnergy(cells, at.Points()), 1e-13 * energy);
    const double bend = descent.Bend(along.View());
    constexpr double kStep = 1e-5;
    const double before = RigidEnergy(cells, at.Plus(-kStep, along).Points());
    const double after = RigidEnergy(cells, at.Plus(kStep, along).Points());
    const double slope = (after - before) / (2 * kStep);
    EXPECT_NEAR(pull.Dot(along), -slope / 2, 1e-7 * std::abs(slope));
    // The second difference of the energy is the first one of its slope.
    const double low = [&] {
      descent.Pull(at.Plus(-kStep, along).View(), scratch.Edit(), n);
      return scratch.Dot(along);
    }();
    descent.Pull(at.Plus(kStep, along).View(), scratch.Edit(), n);
    const double curvature = (low - scratch.Dot(along)) / (2 * kStep);
    EXPECT_NEAR(square(along) - bend, curvature, 1e-6 * square(along));
  }
}

TEST(RigidDescentTest, PlainAndWideGiveTheSameBytes) {
  const Case on(CarBody(24));
  const Shape at(on.n(), 1, 3), along(on.n(), 1, 4);
  RigidDescent plain(on.cells, false), best(on.cells);
  Shape one(on.n()), two(on.n());
  EXPECT_EQ(plain.Pull(at.View(), one.Edit(), on.n()), best.Pull(at.View(), two.Edit(), on.n()));
  EXPECT_EQ(one.x, two.x);
  EXPECT_EQ(one.y, two.y);
  EXPECT_EQ(plain.Bend(along.View()), best.Bend(along.View()));
}

TEST(HardSurfacesTest, AreWhatTheySay) {
  for (const HardSurface& hard : HardSurfaces()) {
    SCOPED_TRACE(hard.name);
    EXPECT_GE(hard.mesh.vertices.size(), 1000u);
    EXPECT_LE(hard.mesh.vertices.size(), 5000u);
    auto cut = CutToCharts(hard.mesh, {}, {}, {});
    ASSERT_TRUE(cut) << cut.error().message;
    const auto charts = Must(MakeCharts(*cut));
    ASSERT_EQ(charts.size(), 1u);
    if (hard.name == "car_body") {
      EXPECT_EQ(charts[0].loops.size(), 12u);
    } else if (hard.name == "tee_body") {
      EXPECT_EQ(charts[0].loops.size(), 4u);
    }
  }
}

// Within a thousandth of where 2,000 plain iterations end.
void ExpectConverged(const std::string& name, const SurfaceMesh& mesh, bool cut = false) {
  SCOPED_TRACE(name);
  const Case on(mesh, cut);
  std::vector<Complex> plain = on.first;
  on.Refine({2000, false, 0}, plain);
  FlattenOptions options = ArapOptions();
  options.cut.auto_cut = cut;
  const Flattening flat = Must(Flatten(mesh, options));
  EXPECT_EQ(flat.charts[0].refine_end, RefineEnd::kConverged);
  EXPECT_LT(flat.charts[0].refinements, 200);
  std::vector<Complex> uv = flat.uv;
  for (Complex& p : uv) p /= on.chart().diagonal;
  // What is isometric is so up to rounding.
  EXPECT_LE(on.Energy(uv), 1.001 * on.Energy(plain) + 1e-20);
}

TEST(RefineTest, EndsWhereTwoThousandPlainIterationsEnd) {
  for (const HardSurface& hard : HardSurfaces()) ExpectConverged(hard.name, hard.mesh);
  ExpectConverged("car body cut", CarBody(80), true);
  ExpectConverged("roll", RolledSheet(20, 8, 10, 4, 1.5, 1).surface);
}

TEST(RefineTest, EndsThereOnTheSurfacesOfTheData) {
  const auto data = TestData();
  if (!data) GTEST_SKIP() << "ARAP_TEST_DATA is not set: NO real surface is tested";
  for (const char* name : {"annulus_cylinder", "dev_accordion", "dev_cone_patch",
                           "dev_rolled_sheet", "garment_skirt_annulus", "garment_skirt_panel_a",
                           "garment_skirt_panel_b", "garment_tee_back", "garment_tee_sleeve_a",
                           "hemisphere", "near_cylinder_skew", "spothead"}) {
    ExpectConverged(name, ReadObj(*data / "3d" / (std::string(name) + ".obj")));
  }
}

TEST(RefineTest, FindsTheMinimumOfTheTextbook) {
  const SurfaceMesh cap = SphereCap(4, 12, 1.3);
  const Case on(cap);
  const DenseArapResult dense = DenseArap(CellsOf(cap), {}, {}, Must(Flatten(cap, {})).uv, 2000);
  FlattenOptions options = ArapOptions();
  options.refine_stop = 0;
  const Flattening flat = Must(Flatten(cap, options));
  EXPECT_EQ(flat.charts[0].refine_end, RefineEnd::kConverged);
  EXPECT_NEAR(FaceEnergy(CellsOf(cap), flat.uv), dense.energy, 1e-10 * dense.energy);
}

TEST(RefineTest, NoStepRaisesTheEnergy) {
  for (const SurfaceMesh& mesh : {TeeBody(52), Starfish(36), TwistedRibbon(240)}) {
    const Case on(mesh);
    double last = on.Energy(on.first);
    for (int steps = 1; steps <= 30; ++steps) {
      std::vector<Complex> uv = on.first;
      EXPECT_LE(on.Refine({steps, true, 0}, uv).taken, steps);
      const double energy = on.Energy(uv);
      EXPECT_LE(energy, (1 + 1e-12) * last) << steps;
      last = energy;
    }
  }
}

TEST(RefineTest, SaysHowItEnded) {
  const SurfaceMesh star = Starfish(24);
  const auto end = [&](FlattenOptions options) {
    const FlatChart chart = Must(Flatten(star, options)).charts.at(0);
    EXPECT_LE(chart.refinements, options.refine);
    return chart.refine_end;
  };
  FlattenOptions options = ArapOptions();
  EXPECT_EQ(end(options), RefineEnd::kConverged);
  options.refine = 2;
  EXPECT_EQ(end(options), RefineEnd::kLimit);
  options.refine = 0;
  EXPECT_EQ(end(options), RefineEnd::kNotRefined);
  EXPECT_EQ(end(LscmOptions()), RefineEnd::kNotRefined);
  options = LscmOptions();
  options.refine = 500;
  EXPECT_EQ(end(options), RefineEnd::kConverged);
}

TEST(RefineTest, FoldsAreNoStart) {
  const SurfaceMesh paw = Paw(72);
  const Case on(paw);
  const auto flips = [&](const std::vector<Complex>& uv) {
    return NotUpright(paw.triangles, uv).size();
  };
  const std::size_t folded = flips(on.first);
  ASSERT_GT(folded, 0u) << "else this tests nothing";
  const auto loose =
      Must(LoosenedFirstStep(*on.system, on.cells, on.chart(), on.ground, on.first, {}));
  EXPECT_LT(flips(loose), folded);
  // It is the step without anchors, roughly.
  const auto free = Must(
      SpectralFirstStep(Must(SpectralSystem(on.cells, on.n())), on.chart(), on.ground, 1e-5, {}));
  double apart = 0, size = 0;
  Complex turn = 0;
  for (std::size_t v = 0; v < on.n(); ++v) turn += std::conj(loose[v]) * free[v];
  turn /= std::abs(turn);
  for (std::size_t v = 0; v < on.n(); ++v) {
    apart += std::norm(turn * loose[v] - free[v]);
    size += std::norm(free[v]);
  }
  EXPECT_LT(apart, 0.01 * size);
  // The first step that is told stays that of the centre edge.
  FlattenOptions options = ArapOptions();
  const Flattening refined = Must(Flatten(paw, options));
  options.refine = 0;
  const Flattening plain = Must(Flatten(paw, options));
  EXPECT_EQ(flips(refined.first_step), flips(plain.first_step));
  EXPECT_LT(refined.distortion.flipped, plain.distortion.flipped);
}

TEST(RefineTest, TheSameEveryTime) {
  const SurfaceMesh tee = TeeBody(40);
  const Flattening one = Must(Flatten(tee, ArapOptions())), two = Must(Flatten(tee, ArapOptions()));
  EXPECT_EQ(one.uv, two.uv);
  EXPECT_EQ(one.charts, two.charts);
}

}  // namespace
}  // namespace arap::testing
