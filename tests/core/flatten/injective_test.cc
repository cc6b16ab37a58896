// Layouts without flips: the descent, pins, the refusal.
#include "core/flatten/injective/injective.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/flatten/distortion.h"
#include "core/flatten/injective/newton.h"
#include "core/flatten/injective/tutte.h"
#include "core/mesh/space.h"
#include "tests/core/flatten/injective_fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/obj.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

// A bumpy finger, open at its root: `rings` around, one vertex at the tip.
SurfaceMesh Finger(std::size_t rings, std::size_t sectors, double length) {
  SurfaceMesh mesh = SphereCap(rings, sectors, 1.0);  // for its triangles
  mesh.vertices[0] = {0, 0, length + 0.5};
  for (std::size_t v = 1; v < mesh.vertices.size(); ++v) {
    const std::size_t ring = (v - 1) / sectors, sector = (v - 1) % sectors;
    const double z = length * (1 - static_cast<double>(ring) / static_cast<double>(rings - 1));
    const double angle =
        2 * std::numbers::pi * static_cast<double>(sector) / static_cast<double>(sectors);
    const double radius = 0.5 + 0.12 * std::sin(7 * z) + 0.08 * std::sin(5 * angle + 3 * z);
    mesh.vertices[v] = {radius * std::cos(angle), radius * std::sin(angle), z};
  }
  return UnitDiagonal(mesh);
}

Result<InjectiveLayout> Lay(const SurfaceMesh& mesh, const std::vector<Complex>& start = {},
                            const InjectiveOptions& options = {}) {
  return FlattenInjective(mesh, WalkLoops(mesh), start, options);
}

// Recounts: no triangle flipped or flat, no inner vertex wound twice, energy as reported.
void ExpectInjective(const SurfaceMesh& mesh, const Result<InjectiveLayout>& layout) {
  ASSERT_TRUE(layout.has_value()) << layout.error().message;
  ASSERT_TRUE(AllFinite(layout->uv));
  std::vector<double> around(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    ASSERT_GT(SignedArea(t, layout->uv), 0);
    for (std::size_t k = 0; k < 3; ++k) {
      around[t[k]] += std::arg((layout->uv[t[(k + 2) % 3]] - layout->uv[t[k]]) /
                               (layout->uv[t[(k + 1) % 3]] - layout->uv[t[k]]));
    }
  }
  for (const auto& loop : WalkLoops(mesh)) {
    for (const std::uint32_t v : loop) around[v] = 0;
  }
  for (const double angle : around) EXPECT_LE(angle, 2 * std::numbers::pi + 1e-6);
  DistortionSum sum;
  for (const Triangle& t : mesh.triangles) {
    sum.Add(
        MeasureTriangle(LayFlat(mesh, t), {layout->uv[t[0]], layout->uv[t[1]], layout->uv[t[2]]}),
        1, 0);
  }
  const Distortion distortion = sum.Mean();
  EXPECT_EQ(distortion.flipped, 0u);
  EXPECT_NEAR(distortion.symmetric_dirichlet, layout->energy, 1e-9 * layout->energy);
}

TEST(InjectiveTest, LaysDeepSurfacesOutWithoutAFlip) {
  for (const SurfaceMesh& mesh :
       {Cap(24, 40, 0.5), Cap(24, 40, 0.95), Cap(24, 40, 0.999), Finger(60, 24, 6),
        Lifted(Annulus(4, 20, 1, 3)), Lifted(Strip(9)), Lifted(SingleTriangle())}) {
    const auto layout = Lay(mesh);
    ExpectInjective(mesh, layout);
    EXPECT_EQ(layout->start, InjectiveStart::kTutte);
    EXPECT_LT(layout->iterations, 300);
  }
}

TEST(InjectiveTest, UntanglesAFingerTooLongForDoubles) {
  const SurfaceMesh finger = Finger(240, 8, 40);
  for (const TutteWeights weights : {TutteWeights::kUniform, TutteWeights::kCotangent}) {
    const auto tutte = TutteEmbedding(finger, WalkLoops(finger), weights);
    ASSERT_FALSE(NotUpright(finger.triangles, *tutte).empty());  // else this tests nothing
  }
  const auto layout = Lay(finger);
  ExpectInjective(finger, layout);
  EXPECT_EQ(layout->start, InjectiveStart::kMended);
}

TEST(InjectiveTest, EndsAtAMinimum) {
  const SurfaceMesh cap = Cap(16, 32, 0.8);
  const auto layout = Lay(cap);
  ExpectInjective(cap, layout);
  auto newton = Newton::Make(cap, {}, {});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<Complex> near = layout->uv;
    const auto noise = Noise(near.size(), 1e-3, seed);
    for (std::size_t v = 0; v < near.size(); ++v) near[v] += noise[v];
    EXPECT_GE(newton.Energy(near, 0) + 4, layout->energy);
  }
  // Whatever the start, the same minimum.
  std::vector<Complex> flipped = layout->uv;
  for (Complex& z : flipped) z = std::conj(z);
  const auto again = Lay(cap, flipped);
  ExpectInjective(cap, again);
  EXPECT_NEAR(again->energy, layout->energy, 1e-4 * layout->energy);
}

TEST(InjectiveTest, LeavesAnIsometryAsItIs) {
  for (const Developable& made :
       {Accordion(8, 6, 4, 1, 2.4, 2), ConePatch(30, 10, 1, 3, 4.4, 5.9, 3)}) {
    const auto layout = Lay(made.surface, made.flat);
    ExpectInjective(made.surface, layout);
    EXPECT_EQ(layout->iterations, 0);
    EXPECT_EQ(layout->uv, made.flat);
    EXPECT_EQ(layout->start, InjectiveStart::kGiven);
  }
}

TEST(InjectiveTest, FindsTheIsometryOfADevelopable) {
  for (const Developable& made : {RolledSheet(40, 12, 10, 4, 1.5, 1), Accordion(8, 6, 4, 1, 2.4, 2),
                                  ConePatch(30, 10, 1, 3, 4.4, 5.9, 3)}) {
    const SurfaceMesh mesh = UnitDiagonal(made.surface);
    const auto layout = Lay(mesh);
    ExpectInjective(mesh, layout);
    EXPECT_NEAR(layout->energy, 4, 1e-12);
    EXPECT_LE(WorstEdge(mesh, layout->uv), 1e-8);
  }
}

TEST(InjectiveTest, GivesTheSameBytes) {
  const SurfaceMesh finger = Finger(40, 16, 4);
  const auto first = Lay(finger), second = Lay(finger);
  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_EQ(first->uv, second->uv);
  EXPECT_EQ(first->iterations, second->iterations);
}

TEST(InjectiveTest, TakesAnyStart) {
  const SurfaceMesh cap = Cap(10, 20, 0.9);
  std::vector<Complex> nan(cap.vertices.size(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<Complex> zero(cap.vertices.size(), 0);
  for (const auto& start : {nan, zero, Noise(cap.vertices.size(), 1, 3)}) {
    const auto layout = Lay(cap, start);
    ExpectInjective(cap, layout);
    EXPECT_EQ(layout->start, InjectiveStart::kTutte);
  }
  // A doubly wound start has upright triangles only, yet is refused: z ↦ z² of a fan.
  SurfaceMesh fan;
  fan.vertices.push_back({0, 0, 0});
  std::vector<Complex> twice{0};
  for (std::uint32_t k = 0; k < 12; ++k) {
    const double angle = k * std::numbers::pi / 6;
    fan.vertices.push_back({std::cos(angle), std::sin(angle), 0.3 * std::sin(4 * angle)});
    twice.push_back(std::polar(1.0, 2 * angle));
    fan.triangles.push_back({0, 1 + k, 1 + (k + 1) % 12});
  }
  EXPECT_TRUE(NotUpright(fan.triangles, twice).empty());
  const auto layout = Lay(fan, twice);
  ExpectInjective(fan, layout);
  EXPECT_EQ(layout->start, InjectiveStart::kTutte);
}

TEST(InjectiveTest, TakesLoopsInEitherDirection) {
  const SurfaceMesh ring = Lifted(Annulus(4, 20, 1, 3));
  Loops loops = WalkLoops(ring);
  for (auto& loop : loops) std::reverse(loop.begin(), loop.end());
  ExpectInjective(ring, FlattenInjective(ring, loops, {}, {}));
}

TEST(InjectivePinsTest, HardPinsAreMetExactly) {
  const SurfaceMesh cap = Cap(10, 20, 0.5);
  const auto last = static_cast<std::uint32_t>(cap.vertices.size() - 1);
  InjectiveOptions options;
  options.pins = {
      {0, {0.1, 0.2}, kHard}, {last, {0.9, 0.3}, kHard}, {last - 7, {0.2, -0.6}, kHard}};
  const auto layout = Lay(cap, {}, options);
  ASSERT_TRUE(layout.has_value()) << layout.error().message;
  EXPECT_TRUE(NotUpright(cap.triangles, layout->uv).empty());
  for (const LayoutPin& pin : options.pins) EXPECT_EQ(layout->uv[pin.vertex], pin.uv);
}

TEST(InjectivePinsTest, TwoHardPinsAreAlwaysMet) {
  // Wild heights; pins at any distance from each other.
  PlanarMesh plane = JitteredGrid(12, 9, 8);
  SurfaceMesh mesh = Lifted(plane);
  Random random(4);
  for (auto& p : mesh.vertices) p[2] += random.Uniform(-0.5, 0.5);
  mesh = UnitDiagonal(mesh);
  for (const double distance : {0.02, 0.3, 5.0}) {
    InjectiveOptions options;
    options.pins = {{0, {1, 1}, kHard}, {12, {1, 1 + distance}, kHard}};
    const auto layout = Lay(mesh, {}, options);
    ExpectInjective(mesh, layout);
    for (const LayoutPin& pin : options.pins) EXPECT_EQ(layout->uv[pin.vertex], pin.uv);
  }
}

TEST(InjectivePinsTest, SoftPinsPull) {
  const SurfaceMesh cap = Cap(10, 20, 0.5);
  const auto last = static_cast<std::uint32_t>(cap.vertices.size() - 1);
  const auto free = Lay(cap);
  ASSERT_TRUE(free.has_value());
  const Complex here = free->uv[last], there = here + 0.2 * (here - free->uv[0]);
  double before = std::abs(here - there);
  for (const double weight : {0.1, 10.0, 1e4}) {
    InjectiveOptions options;
    options.pins = {{0, free->uv[0], weight}, {last, there, weight}};
    const auto layout = Lay(cap, free->uv, options);
    ExpectInjective(cap, layout);  // the energy reported is without the pins
    const double now = std::abs(layout->uv[last] - there);
    EXPECT_LT(now, before);
    before = now;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(InjectivePinsTest, PinsThatAskForAFlipAreRefused) {
  const SurfaceMesh cap = Cap(10, 20, 0.5);
  const Triangle& t = cap.triangles[50];
  InjectiveOptions options;
  options.pins = {{t[0], {0, 0}, kHard}, {t[1], {0, 0.1}, kHard}, {t[2], {0.1, 0}, kHard}};
  auto layout = Lay(cap, {}, options);
  ASSERT_FALSE(layout.has_value());
  EXPECT_EQ(layout.error().kind, FaultKind::kNotInjective);
  EXPECT_EQ(layout.error().elements, std::vector<std::uint32_t>{50});
  // The six neighbours of a hexagon's centre on one line: no single triangle shows it.
  SurfaceMesh fan;
  fan.vertices.push_back({0, 0, 0});
  options.pins.clear();
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double angle = k * std::numbers::pi / 3;
    fan.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    fan.triangles.push_back({0, 1 + k, 1 + (k + 1) % 6});
    options.pins.push_back({1 + k, {0.1 * k, 0}, kHard});
  }
  layout = Lay(fan, {}, options);
  ASSERT_FALSE(layout.has_value());
  EXPECT_EQ(layout.error().kind, FaultKind::kNotInjective);
  EXPECT_FALSE(layout.error().elements.empty());
}

TEST(InjectivePinsTest, PinsThatTangleTheStartAreMended) {
  // The pole of a cap is carried to near its rim: every start is tangled, an answer exists.
  const SurfaceMesh cap = Cap(10, 20, 0.5);
  const auto free = Lay(cap);
  ASSERT_TRUE(free.has_value());
  const auto last = static_cast<std::uint32_t>(cap.vertices.size() - 1);
  const auto across = static_cast<std::uint32_t>(last - 10);
  InjectiveOptions options;
  options.pins = {{last, free->uv[last], kHard},
                  {across, free->uv[across], kHard},
                  {0, free->uv[0] + 0.7 * (free->uv[last] - free->uv[0]), kHard}};
  const auto layout = Lay(cap, free->uv, options);
  ExpectInjective(cap, layout);
  EXPECT_EQ(layout->start, InjectiveStart::kMended);
  for (const LayoutPin& pin : options.pins) EXPECT_EQ(layout->uv[pin.vertex], pin.uv);
}

TEST(InjectivePinsTest, NonsenseIsNamed) {
  const SurfaceMesh cap = Cap(4, 8, 0.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<LayoutPin>& pins : {std::vector<LayoutPin>{{1000, 0, 1}},
                                             {{1, 0, 1}, {1, 0, 1}},
                                             {{1, nan, 1}},
                                             {{1, 0, 0}},
                                             {{1, 0, nan}}}) {
    InjectiveOptions options;
    options.pins = pins;
    const auto layout = Lay(cap, {}, options);
    ASSERT_FALSE(layout.has_value());
    EXPECT_EQ(layout.error().kind, FaultKind::kInvalidOption);
  }
}

TEST(InjectiveTest, TrianglesLeftOutDoNotCount) {
  // An edge of a sheet with a T: vertex n lies on it, closed by a triangle of no area.
  SurfaceMesh mesh = Lifted(Grid(4, 4, 1, 1));
  Triangle& split = mesh.triangles[10];
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  const Triangle old = split;
  mesh.vertices.push_back(
      ToPoint3(0.5 * (Vec(mesh.vertices[old[0]]) + Vec(mesh.vertices[old[1]]))));
  split = {old[0], n, old[2]};
  mesh.triangles.push_back({n, old[1], old[2]});
  mesh.triangles.push_back({old[0], old[1], n});
  InjectiveOptions options;
  options.left_out.assign(mesh.triangles.size(), false);
  options.left_out.back() = true;
  const auto layout = Lay(mesh, {}, options);
  ASSERT_TRUE(layout.has_value()) << layout.error().message;
  EXPECT_TRUE(AllFinite(layout->uv));
  for (std::size_t t = 0; t + 1 < mesh.triangles.size(); ++t) {
    EXPECT_GT(SignedArea(mesh.triangles[t], layout->uv), 0);
  }
}

TEST(InjectiveTest, StopsWhenCancelled) {
  const SurfaceMesh cap = Cap(10, 20, 0.95);
  int asked = 0;
  const CancelToken cancel([&asked]() -> Status {
    if (++asked <= 3) return {};
    return Fail(FaultKind::kCancelled, "enough");
  });
  const auto layout = FlattenInjective(cap, WalkLoops(cap), {}, {}, cancel);
  ASSERT_FALSE(layout.has_value());
  EXPECT_EQ(layout.error().kind, FaultKind::kCancelled);
  EXPECT_EQ(asked, 4);
}

TEST(InjectiveTest, LaysTheDisksOfTheDataFolderOut) {
  const auto data = TestData();
  if (!data) GTEST_SKIP() << "NOT CHECKED: ARAP_TEST_DATA does not name a folder";
  std::size_t disks = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*data / "3d")) {
    if (entry.path().extension() != ".obj") continue;
    const SurfaceMesh mesh = ReadObj(entry.path());
    if (WalkLoops(mesh).size() != 1) continue;
    ++disks;
    ExpectInjective(mesh, Lay(mesh));
  }
  EXPECT_GE(disks, 8u);
}

}  // namespace
}  // namespace arap::testing
