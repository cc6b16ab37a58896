// Pins solved for on factors that have none, and pins factored in: the same layouts, and what the
// first way is for — other pins without another factor.
#include <algorithm>
#include <cmath>
#include <random>

#include "arap/core/flattener.h"
#include "core/mesh/space.h"
#include "tests/core/property/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/obj.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

enum class Kind { kHard, kSoft, kMixed };

// `count` vertices pulled away from where `free` has them, by up to a tenth of the diagonal.
std::vector<UvPin> RandomPins(const std::vector<Complex>& free, double diagonal, std::size_t count,
                              Kind kind, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto next = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<UvPin> pins;
  std::vector<bool> taken(free.size());
  while (pins.size() < count) {
    const auto v = static_cast<std::uint32_t>(random() % free.size());
    if (taken[v]) continue;
    taken[v] = true;
    const bool soft = kind == Kind::kSoft || (kind == Kind::kMixed && pins.size() % 2 == 1);
    const double weight = soft ? std::pow(10.0, 6 * next() - 3) : 0;
    const double du = next() - 0.5, dv = next() - 0.5;
    pins.push_back({v, free[v] + 0.2 * diagonal * Complex(du, dv), weight});
  }
  return pins;
}

double Diagonal(const SurfaceMesh& mesh) {
  Eigen::Vector3d low = Vec(mesh.vertices.front()), high = low;
  for (const Point3& p : mesh.vertices) {
    low = low.cwiseMin(Vec(p)), high = high.cwiseMax(Vec(p));
  }
  return (high - low).norm();
}

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
      for (const Kind kind : {Kind::kHard, Kind::kSoft, Kind::kMixed}) {
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
  for (const Kind kind : {Kind::kHard, Kind::kSoft, Kind::kMixed}) {
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

TEST(PinSolversTest, TheSameOnEverySurfaceOfTheData) {
  const auto data = TestData();
  if (!data) GTEST_SKIP() << "ARAP_TEST_DATA is not set: NO real surface is tested";
  for (const auto& entry : std::filesystem::directory_iterator(*data / "3d")) {
    if (entry.path().extension() != ".obj") continue;
    const SurfaceMesh mesh = ReadObj(entry.path());
    FlattenOptions options;
    options.cut.auto_cut = true;
    const std::vector<Complex> free = Must(Flatten(mesh, options)).uv;
    const std::vector<Complex> places(free.begin(),
                                      free.begin() + static_cast<long>(mesh.vertices.size()));
    for (const Basis basis : {Basis::kFace, Basis::kEdge}) {
      for (const Kind kind : {Kind::kHard, Kind::kSoft, Kind::kMixed}) {
        options.energy = {basis, Weights::kCotangent, {}};
        options.pins = RandomPins(places, Diagonal(mesh), 12, kind, 11);
        EXPECT_LE(Difference(mesh, options), 1e-9)
            << entry.path() << ' ' << static_cast<int>(basis) << static_cast<int>(kind);
      }
    }
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
  options.pins = RandomPins(free, Diagonal(cap), 6, Kind::kHard, 3);
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

// Kept surfaces, other pins.
class RepinTest : public ::testing::Test {
 protected:
  RepinTest() : cap_(SphereCap(12, 24, 1.4)), kept_(Must(Prepare(cap_, {}))) {
    options_.refine = 5;
    free_ = Must(Flatten(cap_, options_)).uv;
  }

  // Nothing factored, and the bytes of a fresh call.
  void ExpectReuse(const FlattenOptions& options) {
    const Flattening again = Must(Flatten(*kept_, options));
    EXPECT_EQ(again.times.order, 0);
    EXPECT_EQ(again.times.factor, 0);
    const Flattening fresh = Must(Flatten(cap_, options));
    EXPECT_GT(fresh.times.factor, 0);
    EXPECT_EQ(again.uv, fresh.uv);
    EXPECT_EQ(again.first_step, fresh.first_step);
  }

  FlattenOptions With(std::size_t pins, Kind kind, std::uint64_t seed) const {
    FlattenOptions options = options_;
    options.pins = RandomPins(free_, Diagonal(cap_), pins, kind, seed);
    return options;
  }

  SurfaceMesh cap_;
  std::shared_ptr<const PreparedSurface> kept_;
  FlattenOptions options_;
  std::vector<Complex> free_;
};

TEST_F(RepinTest, OtherPinsFactorNothing) {
  for (const Basis basis : {Basis::kFace, Basis::kEdge}) {
    options_.energy.basis = basis;
    Must(Flatten(*kept_, With(3, Kind::kMixed, 1)));
    const std::size_t bytes = kept_->bytes();
    std::uint64_t seed = 1;
    for (const std::size_t count : {2u, 3u, 10u, 32u}) {
      for (const Kind kind : {Kind::kHard, Kind::kSoft, Kind::kMixed}) {
        ExpectReuse(With(count, kind, ++seed));
      }
    }
    EXPECT_EQ(kept_->bytes(), bytes);
  }
}

TEST_F(RepinTest, OtherWeightsFactorNothing) {
  FlattenOptions options = With(6, Kind::kSoft, 3);
  Must(Flatten(*kept_, options));
  for (const double weight : {1e-2, 1.0, 1e4, 0.0}) {
    for (UvPin& pin : options.pins) pin.weight = weight;
    ExpectReuse(options);
  }
}

TEST_F(RepinTest, PinsAfterNoneFactorNothing) {
  Must(Flatten(*kept_, options_));
  ExpectReuse(With(4, Kind::kMixed, 5));
  ExpectReuse(options_);
}

// More pins than the shared factors are good for: factored in, with the order that is there.
TEST_F(RepinTest, ManyPinsKeepTheOrder) {
  Must(Flatten(*kept_, options_));
  const FlattenOptions many = With(kDirectPins + 1, Kind::kMixed, 6);
  const Flattening again = Must(Flatten(*kept_, many));
  EXPECT_EQ(again.uv, Must(Flatten(cap_, many)).uv);
  EXPECT_GT(again.times.factor, 0);
  ExpectReuse(many);
  for (const UvPin& pin : many.pins) {
    if (pin.weight == 0) {
      EXPECT_EQ(again.uv[pin.vertex], pin.uv);
    }
  }
}

// Other edge weights are another matrix of the same pattern: a factor of its own, made with the
// order that is there, with the bytes of a fresh call.
TEST_F(RepinTest, OtherEnergiesKeepTheOrder) {
  options_.energy.basis = Basis::kEdge;
  Must(Flatten(*kept_, options_));
  FlattenOptions uniform = options_;
  uniform.energy.weights = Weights::kUniform;
  const Flattening again = Must(Flatten(*kept_, uniform));
  EXPECT_GT(again.times.factor, 0);
  EXPECT_EQ(again.uv, Must(Flatten(cap_, uniform)).uv);
  ExpectReuse(uniform);
  ExpectReuse(options_);
}

}  // namespace
}  // namespace arap::testing
