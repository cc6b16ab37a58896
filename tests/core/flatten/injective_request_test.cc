// Layouts without flips, asked of the flattener.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/flatten/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

TEST(InjectiveRequestTest, LayoutsWithoutFlipsOnRequest) {
  const SurfaceMesh ball = SphereCap(20, 30, 2.8);
  FlattenOptions options;
  options.method = FlattenMethod::kFirstStep;
  options.anchors = FlattenAnchors::kCentreEdge;
  ASSERT_GT(Must(Flatten(ball, options)).distortion.flipped, 0u);  // else there is nothing to show
  options.injective = true;
  const Flattening flat = Must(Flatten(ball, options));
  CheckSound(ball, flat);
  EXPECT_EQ(flat.distortion.flipped, 0u);
  for (const auto& t : flat.corner_uv) EXPECT_GT(SignedArea(t, flat.uv), 0);
}

// Pins that turn a triangle over leave no such layout.
TEST(InjectiveRequestTest, AnImpossibleLayoutIsRefused) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.0);
  const Triangle& t = cap.triangles[30];
  FlattenOptions options;
  options.injective = true;
  options.pins = {{t[0], {0, 0}, 0}, {t[1], {0, 0.1}, 0}, {t[2], {0.1, 0}, 0}};
  const auto flat = Flatten(cap, options);
  ASSERT_FALSE(flat.has_value());
  EXPECT_EQ(flat.error().kind, FaultKind::kNotInjective);
}

// The numbers are those of the input, whichever chart it is and whatever was left out.
TEST(InjectiveRequestTest, AnImpossibleLayoutIsToldInTheNumbersOfTheInput) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.0);
  SurfaceMesh two = cap;
  two.vertices.push_back({9, 9, 9});  // in no triangle
  const auto first = static_cast<std::uint32_t>(two.vertices.size());
  for (const Point3& p : cap.vertices) two.vertices.push_back({p[0] + 10, p[1], p[2]});
  for (const Triangle& t : cap.triangles) {
    two.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const std::size_t flipped = cap.triangles.size() + 30;
  const Triangle& t = two.triangles[flipped];
  FlattenOptions options;
  options.injective = true;
  options.pins = {{t[0], {0, 0}, 0}, {t[1], {0, 0.1}, 0}, {t[2], {0.1, 0}, 0}};
  const auto flat = Flatten(two, options);
  ASSERT_FALSE(flat.has_value());
  EXPECT_EQ(flat.error().kind, FaultKind::kNotInjective);
  EXPECT_EQ(flat.error().elements, (std::vector{static_cast<std::uint32_t>(flipped)}));
  EXPECT_EQ(flat.error().message, "The pins of vertices " + std::to_string(t[0]) + ", " +
                                      std::to_string(t[1]) + " and " + std::to_string(t[2]) +
                                      " flip triangle " + std::to_string(flipped) + ".");
}

// Twelve upright triangles round one vertex, which they wind round twice.
TEST(InjectiveRequestTest, AVertexWoundTwiceIsNotInjective) {
  SurfaceMesh cone;
  cone.vertices.push_back({0, 0, 0});
  for (std::uint32_t k = 0; k < 12; ++k) {
    const double angle = 2 * std::numbers::pi * k / 12;
    // Heights to and fro, so that the twelve sides have the length of the arms.
    cone.vertices.push_back({std::cos(angle), std::sin(angle), k % 2 == 0 ? 0.9 : -0.9});
    cone.triangles.push_back({0, k + 1, (k + 1) % 12 + 1});
  }
  FlattenOptions options = Refined();
  options.injective = true;
  const Flattening flat = Must(Flatten(cone, options));
  double around = 0;
  for (const auto& t : flat.corner_uv) {
    EXPECT_GT(SignedArea(t, flat.uv), 0);
    around += std::arg((flat.uv[t[2]] - flat.uv[t[0]]) / (flat.uv[t[1]] - flat.uv[t[0]]));
  }
  EXPECT_NEAR(around, 2 * std::numbers::pi, 1e-9);
}

}  // namespace
}  // namespace arap::testing
