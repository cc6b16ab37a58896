// Pins solved for on factors that have none, and pins factored in: the same layouts.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "core/mesh/space.h"
#include "tests/core/flatten/fixture.h"
#include "tests/support/obj.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

double LargestDifference(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double largest = 0;
  for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, std::abs(a[v] - b[v]));
  return largest;
}

// Both solvers with the same pins; returns by how much they differ, as a part of the diagonal.
double Difference(const SurfaceMesh& mesh, const FlattenOptions& options) {
  const Flattening direct = Must(Flatten(mesh, options, {}, {}, PinSolver::kDirect));
  const Flattening shared = Must(Flatten(mesh, options, {}, {}, PinSolver::kNullSpace));
  for (const UvPin& pin : options.pins) {
    if (pin.weight == 0) {
      EXPECT_EQ(shared.uv[pin.vertex], pin.uv);
    }
  }
  return std::max(LargestDifference(direct.uv, shared.uv),
                  LargestDifference(direct.first_step, shared.first_step)) /
         Diagonal(mesh);
}

TEST(PinSolversTest, TheSameMinimiserEitherWay) {
  const SurfaceMesh two =
      Together(SphereCap(14, 30, 1.6), ConePatch(20, 8, 1, 3, 4, 5, 3).surface, {8, 0, 0});
  const std::vector<Complex> free = Must(Flatten(two, {})).uv;
  std::uint64_t seed = 0;
  for (const Basis basis : {Basis::kFace, Basis::kEdge, Basis::kEdgeAsPublished}) {
    for (const Weights weights : {Weights::kCotangent, Weights::kUniform}) {
      for (const PinKind kind : {PinKind::kHard, PinKind::kSoft, PinKind::kMixed}) {
        for (const std::size_t count : {4u, 9u, 30u}) {
          for (const auto method : {FlattenMethod::kArap, FlattenMethod::kFirstStep}) {
            FlattenOptions options;
            options.method = method;
            options.energy = {basis, weights, {}};
            options.pins = RandomPins(free, Diagonal(two), count, kind, ++seed);
            EXPECT_LE(Difference(two, options), 1e-9)
                << static_cast<int>(basis) << static_cast<int>(weights) << static_cast<int>(kind)
                << ' ' << count << ' ' << static_cast<int>(method);
          }
        }
      }
    }
  }
}

TEST(PinSolversTest, TheSameWhenRefinedAndOfOtherKinds) {
  const SurfaceMesh cap = SphereCap(14, 30, 1.6);
  const std::vector<Complex> free = Must(Flatten(cap, {})).uv;
  for (const PinKind kind : {PinKind::kHard, PinKind::kSoft, PinKind::kMixed}) {
    FlattenOptions options;
    options.pins = RandomPins(free, Diagonal(cap), 5, kind, 7);
    FlattenOptions refined = options, far = options, rigid = options, angles = options;
    refined.refine = 10;
    far.anchors = FlattenAnchors::kFarBoundary;
    for (std::size_t t = 0; t < cap.triangles.size(); ++t) {
      rigid.energy.rigidity.push_back(t % 3 == 0 ? 20 : 1);
    }
    angles.method = FlattenMethod::kAbf;
    for (const FlattenOptions& asked : {refined, far, rigid, angles}) {
      EXPECT_LE(Difference(cap, asked), 1e-9) << static_cast<int>(kind);
    }
  }
}

// Two pins, next to each other or on the vertices that are grounded, and all three of a triangle.
TEST(PinSolversTest, FewAndClosePins) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const std::vector<std::uint32_t> anchors = Must(Flatten(cap, {})).charts[0].anchors;
  for (const auto& [a, b] : {std::pair{0u, 1u}, {anchors[0], anchors[1]}, {anchors[0], 150u}}) {
    for (const double weight : {0.0, 2.0}) {
      FlattenOptions options;
      options.pins = {{a, {3, 4}, weight}, {b, {3.2, 4.1}, 0}};
      EXPECT_LE(Difference(cap, options), 1e-9) << a << ' ' << b << ' ' << weight;
    }
  }
  SurfaceMesh one;
  one.vertices = {{0, 0, 0}, {1, 0, 1}, {0, 2, 1}};
  one.triangles = {{0, 1, 2}};
  FlattenOptions options;
  options.pins = {{0, {0, 0}, 0}, {1, {1, 0.5}, 0}, {2, {0.2, 1.5}, 0.5}};
  EXPECT_LE(Difference(one, options), 1e-9);
}

// `name` in whatever way it has to be cut.
void ExpectTheSame(const std::string& name, const SurfaceMesh& mesh) {
  FlattenOptions options;
  options.cut.auto_cut = true;
  const std::vector<Complex> free = Must(Flatten(mesh, options)).uv;
  const std::vector<Complex> places(free.begin(),
                                    free.begin() + static_cast<long>(mesh.vertices.size()));
  for (const Basis basis : {Basis::kFace, Basis::kEdge}) {
    for (const PinKind kind : {PinKind::kHard, PinKind::kSoft, PinKind::kMixed}) {
      options.energy = {basis, Weights::kCotangent, {}};
      options.pins = RandomPins(places, Diagonal(mesh), 12, kind, 11);
      EXPECT_LE(Difference(mesh, options), 1e-9)
          << name << ' ' << static_cast<int>(basis) << static_cast<int>(kind);
    }
  }
}

TEST(PinSolversTest, TheSameOnSurfacesOfEveryKind) {
  ExpectTheSame("band", Band().first);
  ExpectTheSame("deep cap", SphereCap(12, 24, 2.6));
  ExpectTheSame("ball", Sphere(12, 20));
  ExpectTheSame("torus", Torus(16, 10, 3, 1));
  ExpectTheSame("accordion", Accordion(8, 6, 4, 1, 2.4, 2).surface);
  ExpectTheSame("two caps", Together(SphereCap(6, 12, 1.2), SphereCap(8, 16, 1.5), {5, 0, 0}));
}

TEST(PinSolversTest, TheSameOnEverySurfaceOfTheData) {
  const auto data = TestData();
  if (!data) GTEST_SKIP() << "ARAP_TEST_DATA is not set: NO real surface is tested";
  for (const auto& entry : std::filesystem::directory_iterator(*data / "3d")) {
    if (entry.path().extension() == ".obj") ExpectTheSame(entry.path(), ReadObj(entry.path()));
  }
}

// At its tip a conformal map of a long thimble shrinks to nothing.
TEST(PinSolversTest, TheSameOnALongThimble) {
  SurfaceMesh thimble = SphereCap(6, 12, 1.5707963267948966);
  const auto first = static_cast<std::uint32_t>(thimble.vertices.size() - 12);
  for (std::uint32_t ring = 1; ring <= 60; ++ring) {
    const std::uint32_t low = first + 12 * (ring - 1);
    for (std::uint32_t k = 0; k < 12; ++k) {
      const Eigen::Vector3d rim = Vec(thimble.vertices[first + k]);
      thimble.vertices.push_back({rim.x(), rim.y(), -0.5 * ring});
      const std::uint32_t next = (k + 1) % 12;
      thimble.triangles.push_back({low + k, low + 12 + k, low + 12 + next});
      thimble.triangles.push_back({low + k, low + 12 + next, low + next});
    }
  }
  const auto last = static_cast<std::uint32_t>(thimble.vertices.size() - 1);
  FlattenOptions options;
  options.method = FlattenMethod::kFirstStep;
  options.pins = {{0, {0, 0}, 0}, {last, {10, 0}, 0}, {last / 2, {5, 2}, 3}};
  EXPECT_LE(Difference(thimble, options), 1e-9);
}

// The lightest and heaviest pins that are allowed.
TEST(PinSolversTest, WeightsFarApart) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const std::vector<Complex> free = Must(Flatten(cap, {})).uv;
  FlattenOptions options;
  options.pins = RandomPins(free, Diagonal(cap), 6, PinKind::kHard, 3);
  for (std::size_t i = 0; i < 6; ++i) {
    options.pins[i].weight = i % 2 == 0 ? kMaxPinWeight : kMinPinWeight;
  }
  EXPECT_LE(Difference(cap, options), 1e-9);
}

// Two pieces of paper that only a needle's width joins: what holds the one says little of where
// the other is. Pins on both are factored in then, kept surface or not.
TEST(PinSolversTest, WhereTheGroundIsNoHoldPinsAreFactoredIn) {
  constexpr double kWidth = 1e-9;
  SurfaceMesh bow;
  bow.vertices = {{0, -kWidth, 0}, {0, kWidth, 0}, {-1, 0, 0},   {-1, 1, 0.3},
                  {-1, -1, 0.2},   {1, 0, 0},      {1, 1, -0.4}, {1, -1, 0.5}};
  bow.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 2, 4}, {1, 0, 5}, {1, 5, 6}, {0, 7, 5}};
  FlattenOptions options;
  options.energy.weights = Weights::kUniform;
  options.pins = {{3, {-1, 1}, 0}, {4, {-1.1, -1}, 0}, {6, {1.2, 1}, 0}, {7, {1, -1.1}, 5}};
  const auto refused = Flatten(bow, options, {}, {}, PinSolver::kNullSpace);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().kind, FaultKind::kNumerical);
  const Flattening direct = Must(Flatten(bow, options, {}, {}, PinSolver::kDirect));
  const auto kept = Must(Prepare(bow, {}));
  for (int round = 0; round < 2; ++round) {
    const Flattening flat = Must(Flatten(*kept, options));
    EXPECT_EQ(flat.uv, direct.uv);
    EXPECT_EQ(flat.uv[3], options.pins[0].uv);
  }
}

}  // namespace
}  // namespace arap::testing
