// The flat angles fit together, developables keep theirs, and angles come out better than LSCM's.
#include "core/flatten/abf/abf.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arap/core/flattener.h"
#include "core/energy/assemble.h"
#include "core/energy/cells.h"
#include "core/flatten/distortion.h"
#include "core/flatten/layout/first_step.h"
#include "core/mesh/space.h"
#include "core/sparse/factor.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"
#include "tests/support/obj.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

constexpr double kPi = std::numbers::pi;

Topology Of(const SurfaceMesh& mesh) { return BuildTopology(mesh.vertices.size(), mesh.triangles); }

TriangleAngles PlaneAngles(const Triangle& t, const std::vector<Complex>& p) {
  TriangleAngles angles{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Complex at = p[t[k]];
    angles[k] = std::arg((p[t[(k + 2) % 3]] - at) / (p[t[(k + 1) % 3]] - at));
  }
  return angles;
}

// The first step of a flattening with FACE cells and cotangents, the centre edge held.
Flattening FirstStep(const SurfaceMesh& mesh) {
  FlattenOptions options;
  options.method = FlattenMethod::kFirstStep;
  options.anchors = FlattenAnchors::kCentreEdge;
  return *Flatten(mesh, options);
}

std::vector<Complex> Lscm(const SurfaceMesh& mesh) { return FirstStep(mesh).uv; }

// The same with triangles of other angles.
std::vector<Complex> FromAngles(const SurfaceMesh& mesh,
                                const std::vector<TriangleAngles>& angles) {
  const TriangleFrame frame = [&](std::uint32_t t) {
    const Triangle& c = mesh.triangles[t];
    return FrameOfAngles(angles[t], (Vec(mesh.vertices[c[1]]) - Vec(mesh.vertices[c[0]])).norm());
  };
  const EnergyOptions options{Basis::kFace, Weights::kCotangent, {}};
  const auto system = BuildCells(mesh.triangles, Of(mesh), options, frame, false);
  const auto anchors = FirstStep(mesh).charts[0].anchors;
  const double length = (Vec(mesh.vertices[anchors[1]]) - Vec(mesh.vertices[anchors[0]])).norm();
  const Held held{{{anchors[0], 0, 0}, {anchors[1], length, 0}}};
  const std::size_t n = mesh.vertices.size();
  return *HeldFirstStep(*HeldSystem(system->cells, held, n), held, n);
}

// Root of the mean squared relative change of corner angles: what angle-based flattening minimises.
double AngleError(const SurfaceMesh& mesh, const std::vector<Complex>& uv) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto rest = LayFlat(mesh, t);
    const TriangleAngles before = PlaneAngles({0, 1, 2}, {rest[0], rest[1], rest[2]});
    const TriangleAngles after = PlaneAngles(t, uv);
    for (std::size_t k = 0; k < 3; ++k) sum += std::pow((after[k] - before[k]) / before[k], 2);
  }
  return std::sqrt(sum / static_cast<double>(3 * mesh.triangles.size()));
}

double LargestChange(const SurfaceMesh& mesh, const std::vector<TriangleAngles>& angles,
                     const std::vector<Complex>& uv) {
  double largest = 0;
  for (std::size_t t = 0; t < angles.size(); ++t) {
    const TriangleAngles flat = PlaneAngles(mesh.triangles[t], uv);
    for (std::size_t k = 0; k < 3; ++k) {
      largest = std::max(largest, std::abs(angles[t][k] - flat[k]));
    }
  }
  return largest;
}

// A jittered grid of unit cells with every vertex lifted by up to `height`.
SurfaceMesh Crumpled(std::size_t n, double height, std::uint64_t seed) {
  const PlanarMesh grid = JitteredGrid(n, n, seed);
  Random random(seed + 1);
  SurfaceMesh mesh{{}, grid.triangles};
  for (const Complex p : grid.vertices) {
    mesh.vertices.push_back({p.real(), p.imag(), random.Uniform(0, height)});
  }
  return mesh;
}

std::vector<TriangleAngles> Flat(const SurfaceMesh& mesh, int steps = kMaxAngleSteps) {
  auto angles = FlatAngles(mesh, Of(mesh), {}, steps);
  if (!angles) ADD_FAILURE() << angles.error().message;
  return angles ? *std::move(angles) : std::vector<TriangleAngles>(mesh.triangles.size());
}

TEST(AbfTest, AFrameHasItsAngles) {
  const TriangleAngles angles{0.3, 0.9, kPi - 1.2};
  const auto frame = FrameOfAngles(angles, 2.5);
  EXPECT_EQ(frame[0], Complex(0));
  EXPECT_EQ(frame[1], Complex(2.5));
  const TriangleAngles found = PlaneAngles({0, 1, 2}, {frame[0], frame[1], frame[2]});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], angles[k], 1e-14);
}

TEST(AbfTest, DevelopablesKeepTheirAngles) {
  for (const Developable& made : {RolledSheet(40, 12, 10, 4, 1.5, 1), Accordion(8, 6, 4, 1, 2.4, 2),
                                  ConePatch(30, 10, 1, 3, 4.4, 5.9, 3)}) {
    for (const int steps : {1, kMaxAngleSteps}) {
      EXPECT_LE(LargestChange(made.surface, Flat(made.surface, steps), made.flat), 1e-8) << steps;
    }
  }
}

TEST(AbfTest, HolesConstrainNothing) {
  const PlanarMesh ring = Annulus(4, 24, 1, 2);
  SurfaceMesh mesh{{}, ring.triangles};
  for (const Complex p : ring.vertices) mesh.vertices.push_back({p.real(), 0.5, p.imag()});
  EXPECT_LE(LargestChange(mesh, Flat(mesh), ring.vertices), 1e-8);
}

TEST(AbfTest, WithoutInteriorVerticesAnglesStay) {
  const PlanarMesh strip = Strip(7);
  SurfaceMesh mesh{{}, strip.triangles};
  for (const Complex p : strip.vertices) {
    mesh.vertices.push_back({p.real(), p.imag(), std::sin(3 * p.real())});
  }
  const auto angles = Flat(mesh);
  for (std::size_t t = 0; t < angles.size(); ++t) {
    const auto rest = LayFlat(mesh, mesh.triangles[t]);
    const TriangleAngles own = PlaneAngles({0, 1, 2}, {rest[0], rest[1], rest[2]});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(angles[t][k], own[k], 1e-12);
  }
}

// Angles that fit are those of a layout: a similar layout with their frames has exactly them.
TEST(AbfTest, AnglesOfACapFitTogether) {
  for (const double polar : {0.5, 0.8}) {
    const SurfaceMesh cap = SphereCap(12, 24, polar * kPi);
    const auto angles = Flat(cap);
    EXPECT_LE(LargestChange(cap, angles, FromAngles(cap, angles)), 1e-7) << polar;
    const AngleResidual residual = ResidualOf(cap.triangles, Of(cap), angles);
    EXPECT_LE(residual.sum, 1e-12);
    EXPECT_LE(residual.wheel, 1e-9);
  }
}

TEST(AbfTest, NewtonStepsLowerTheResidual) {
  const SurfaceMesh cap = SphereCap(12, 24, 0.5 * kPi);
  const Topology topology = Of(cap);
  const double one = ResidualOf(cap.triangles, topology, Flat(cap, 1)).wheel;
  const double two = ResidualOf(cap.triangles, topology, Flat(cap, 2)).wheel;
  const double three = ResidualOf(cap.triangles, topology, Flat(cap, 3)).wheel;
  EXPECT_GT(one, 1e-6);  // else this test shows nothing
  EXPECT_LT(two, 0.01 * one);
  EXPECT_LT(three, 0.01 * two);
}

// Σ ((α − β)/β)² of a layout, with β the angles of the surface scaled to 2π around the vertices
// that `interior` marks.
double Objective(const SurfaceMesh& mesh, const std::vector<bool>& interior,
                 const std::vector<Complex>& uv) {
  std::vector<double> around(uv.size(), 0.0);
  std::vector<TriangleAngles> target;
  for (const Triangle& t : mesh.triangles) {
    const auto rest = LayFlat(mesh, t);
    target.push_back(PlaneAngles({0, 1, 2}, {rest[0], rest[1], rest[2]}));
    for (std::size_t k = 0; k < 3; ++k) around[t[k]] += target.back()[k];
  }
  double sum = 0;
  for (std::size_t f = 0; f < target.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const TriangleAngles flat = PlaneAngles(t, uv);
    for (std::size_t k = 0; k < 3; ++k) {
      const double beta = target[f][k] * (interior[t[k]] ? 2 * kPi / around[t[k]] : 1);
      sum += std::pow(flat[k] / beta - 1, 2);
    }
  }
  return sum;
}

// How many moves of one vertex by a little bit in one direction make a layout better.
int BetterMoves(const SurfaceMesh& mesh, const std::vector<Complex>& uv) {
  std::vector<bool> interior(uv.size(), true);
  for (const Edge& e : Of(mesh).edges) {
    if (e.boundary()) interior[e.v0] = interior[e.v1] = false;
  }
  const double best = Objective(mesh, interior, uv);
  int better = 0;
  for (std::size_t v = 0; v < uv.size(); ++v) {
    for (const Complex move : {Complex(1), Complex(-1), Complex(0, 1), Complex(0, -1)}) {
      std::vector<Complex> other = uv;
      other[v] += 1e-5 * move;
      if (Objective(mesh, interior, other) < best) ++better;
    }
  }
  return better;
}

// Every layout has angles that fit, so that the best of them is where no vertex wants to move.
TEST(AbfTest, NoLayoutNearbyHasBetterAngles) {
  const SurfaceMesh mesh = Crumpled(6, 0.7, 5);
  EXPECT_EQ(BetterMoves(mesh, FromAngles(mesh, Flat(mesh))), 0);
  EXPECT_GT(BetterMoves(mesh, Lscm(mesh)), 0);
}

TEST(AbfTest, AHemisphereKeepsItsAnglesBetterThanLscm) {
  for (const double polar : {0.25, 0.5, 0.8}) {
    const SurfaceMesh cap = SphereCap(20, 40, polar * kPi);
    EXPECT_LE(AngleError(cap, FromAngles(cap, Flat(cap))), AngleError(cap, Lscm(cap))) << polar;
  }
}

TEST(AbfTest, CrumpledSurfacesComeOutUpright) {
  for (const double height : {2.0, 5.0, 10.0}) {
    const SurfaceMesh mesh = Crumpled(12, height, 3);
    const auto angles = Flat(mesh);
    for (const TriangleAngles& a : angles) {
      EXPECT_GT(*std::min_element(a.begin(), a.end()), 0);
      EXPECT_NEAR(a[0] + a[1] + a[2], kPi, 1e-12);
    }
    EXPECT_EQ(CountFlipped(mesh.triangles, FromAngles(mesh, angles)), 0u) << height;
  }
  const SurfaceMesh mesh = Crumpled(12, 10, 3);
  EXPECT_GT(CountFlipped(mesh.triangles, Lscm(mesh)), 0u);  // else there was nothing to show
}

// Spikes that no angles fit: whatever comes is finite and each triangle is one.
TEST(AbfTest, WhenNothingFitsTheAnglesAreStillThoseOfTriangles) {
  const SurfaceMesh mesh = Crumpled(12, 1000, 3);
  for (const TriangleAngles& a : Flat(mesh)) {
    for (const double angle : a) EXPECT_TRUE(angle > 0 && angle < kPi) << angle;
    EXPECT_NEAR(a[0] + a[1] + a[2], kPi, 1e-9);
  }
}

TEST(AbfTest, TheSameEveryTime) {
  const SurfaceMesh mesh = Crumpled(12, 3, 3);
  EXPECT_EQ(Flat(mesh), Flat(mesh));
}

TEST(AbfTest, NamesItsFaults) {
  const SurfaceMesh closed{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                           {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_EQ(FlatAngles(closed, Of(closed)).error().kind, FaultKind::kNotADisk);
  const SurfaceMesh cap = SphereCap(4, 8, 1);
  for (const int steps : {0, kMaxAngleSteps + 1}) {
    EXPECT_EQ(FlatAngles(cap, Of(cap), {}, steps).error().kind, FaultKind::kInvalidOption);
  }
  const CancelToken cancel([] { return Status(Fail(FaultKind::kCancelled, "enough")); });
  EXPECT_EQ(FlatAngles(cap, Of(cap), cancel).error().kind, FaultKind::kCancelled);
}

TEST(AbfTest, RealSurfacesKeepTheirAnglesBetterThanLscm) {
  const auto data = TestData();
  if (!data) GTEST_SKIP() << "NOT CHECKED: ARAP_TEST_DATA does not name a folder";
  for (const char* name : {"garment_tee_back", "garment_tee_sleeve_a", "garment_skirt_panel_a",
                           "garment_skirt_panel_b", "hemisphere", "spothead"}) {
    const SurfaceMesh mesh = ReadObj(*data / "3d" / (std::string(name) + ".obj"));
    ASSERT_FALSE(mesh.triangles.empty()) << name;
    const std::vector<Complex> uv = FromAngles(mesh, Flat(mesh));
    EXPECT_LE(AngleError(mesh, uv), AngleError(mesh, Lscm(mesh))) << name;
    EXPECT_EQ(CountFlipped(mesh.triangles, uv), 0u) << name;
  }
}

}  // namespace
}  // namespace arap::testing
