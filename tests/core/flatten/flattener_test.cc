// Developable surfaces come out isometric, and the flattener agrees with the paper in dense
// matrices and with the continuous problem.
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/space.h"
#include "tests/core/flatten/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/hemisphere.h"
#include "tests/support/surfaces.h"
#include "tests/support/textbook.h"

namespace arap::testing {
namespace {

// Anchored at the centre edge, as in the paper.
FlattenOptions Paper(Basis basis, Weights weights, int refine = 0) {
  FlattenOptions options;
  options.energy = {basis, weights, {}};
  options.anchors = FlattenAnchors::kCentreEdge;
  options.refine = refine;
  return options;
}

const std::vector<std::pair<Basis, Weights>> kVariants{{Basis::kEdge, Weights::kUniform},
                                                       {Basis::kEdge, Weights::kCotangent},
                                                       {Basis::kEdgeAsPublished, Weights::kUniform},
                                                       {Basis::kFace, Weights::kUniform},
                                                       {Basis::kFace, Weights::kCotangent}};

TEST(FlattenTest, DevelopableSurfacesAreIsometric) {
  for (const Developable& made : {RolledSheet(40, 12, 10, 4, 1.5, 1), Accordion(8, 6, 4, 1, 2.4, 2),
                                  ConePatch(30, 10, 1, 3, 4.4, 5.9, 3)}) {
    for (const auto& [basis, weights] : kVariants) {
      const Flattening flat = Must(Flatten(made.surface, Paper(basis, weights)));
      EXPECT_LE(WorstEdge(made.surface, flat.uv), 1e-8)
          << static_cast<int>(basis) << ' ' << static_cast<int>(weights);
      EXPECT_EQ(flat.distortion.flipped, 0u);
      EXPECT_LE(RelativeDistanceUpToMotion(flat.uv, made.flat), 1e-8);
    }
  }
}

TEST(FlattenTest, EveryMethodIsExactOnDevelopables) {
  const Developable made = ConePatch(30, 10, 1, 3, 4.4, 5.9, 3);
  for (const auto method : {FlattenMethod::kArap, FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
    for (const auto anchors :
         {FlattenAnchors::kCentreEdge, FlattenAnchors::kFarBoundary, FlattenAnchors::kSpectral}) {
      // Of all anchors the distance of two far vertices is not what it is in the plane: the shape
      // is exact up to its scale then.
      FlattenOptions options;
      options.method = method;
      options.anchors = anchors;
      const Flattening flat = Must(Flatten(made.surface, options));
      CheckSound(made.surface, flat);
      if (method != FlattenMethod::kArap && anchors == FlattenAnchors::kFarBoundary) continue;
      EXPECT_LE(RelativeDistanceUpToMotion(flat.uv, made.flat), 1e-8)
          << static_cast<int>(method) << ' ' << static_cast<int>(anchors);
      EXPECT_NEAR(flat.distortion.area_ratio, 1, 1e-8);
    }
  }
}

TEST(FlattenTest, AgreesWithTheTextbookOnACap) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  for (const bool both : {true, false}) {
    for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
      const Basis basis = both ? Basis::kEdge : Basis::kEdgeAsPublished;
      const Flattening flat = Must(Flatten(cap, Paper(basis, weights)));
      std::vector<Complex> first;
      const auto expected = TextbookFlatten(cap, both, weights, flat.charts[0].anchors[0],
                                            flat.charts[0].anchors[1], &first);
      // The paper's first anchor lies at 0 and the other on the u axis; ours where the sheet has
      // them.
      const Complex from = flat.first_step[flat.charts[0].anchors[0]];
      const Complex along = flat.first_step[flat.charts[0].anchors[1]] - from;
      if (!both) {
        EXPECT_EQ(from, Complex(0));
      }
      const auto placed = [&](std::vector<Complex> shape) {
        for (Complex& p : shape) p = from + along / std::abs(along) * p;
        return shape;
      };
      EXPECT_LE(RelativeDistance(flat.first_step, placed(first)), 1e-7);
      EXPECT_LE(RelativeDistance(flat.uv, placed(expected)), 1e-7);
    }
  }
}

// The rim of every mesh is the equator. Errors that fall from mesh to mesh tell a limit from a
// coincidence.
TEST(HemisphereFlattenTest, ReachesTheContinuousEnergy) {
  const double continuous = FlattenHemisphere(2000).arap_energy;
  double last = 1;
  for (const std::size_t rings : {8u, 16u, 32u}) {
    const SurfaceMesh hemisphere = SphereCap(rings, 4 * rings, 0.5 * std::numbers::pi);
    FlattenOptions options;
    options.energy = {Basis::kFace, Weights::kCotangent, {}};
    options.refine = 200;
    const Flattening flat = Must(Flatten(hemisphere, options));
    const double error = std::abs(flat.distortion.arap_energy / continuous - 1);
    EXPECT_LT(error, 0.5 * last) << rings;
    last = error;
  }
  EXPECT_LE(last, 0.02);
}

TEST(FlattenTest, RefiningDescendsTheReportedEnergy) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.4);
  double last = 1e300;
  for (const int refine : {0, 1, 2, 5, 20, 100}) {
    const Flattening flat = Must(Flatten(cap, Paper(Basis::kFace, Weights::kCotangent, refine)));
    EXPECT_LE(flat.distortion.arap_energy, last * (1 + 1e-12)) << refine;
    last = flat.distortion.arap_energy;
  }
}

TEST(FlattenTest, KeepsTheUnitOfTheInput) {
  SurfaceMesh cap = SphereCap(6, 12, 1.2);
  const Flattening small = Must(Flatten(cap, {}));
  for (auto& p : cap.vertices) p = ToPoint3(1000 * Vec(p) + Eigen::Vector3d(1e6, -1e6, 1e6));
  const Flattening large = Must(Flatten(cap, {}));
  for (std::size_t v = 0; v < small.uv.size(); ++v) {
    EXPECT_LE(std::abs(large.uv[v] - 1000.0 * small.uv[v]), 1e-5);
  }
}

TEST(FlattenTest, CancellationReachesTheLoops) {
  const SurfaceMesh cap = SphereCap(12, 30, 1.4);
  int asked = 0;
  const CancelToken count([&]() -> Status {
    ++asked;
    return {};
  });
  FlattenOptions options;
  ASSERT_TRUE(Flatten(cap, options, {}, count).has_value());
  const int without = std::exchange(asked, 0);
  options.refine = 200;
  const auto refined = Flatten(cap, options, {}, count);
  ASSERT_TRUE(refined.has_value());
  ASSERT_GT(refined->charts[0].refinements, 10);
  const int total = asked;
  EXPECT_GE(total, without + refined->charts[0].refinements) << "asked before every iteration";
  for (const int when : {1, total / 2, total}) {
    asked = 0;
    const CancelToken stop([&]() -> Status {
      if (++asked < when) return {};
      return Fail(FaultKind::kCancelled, "enough");
    });
    const auto flat = Flatten(cap, options, {}, stop);
    ASSERT_FALSE(flat.has_value());
    EXPECT_EQ(flat.error().kind, FaultKind::kCancelled);
    EXPECT_EQ(asked, when);
  }
}

}  // namespace
}  // namespace arap::testing
