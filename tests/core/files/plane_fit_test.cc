#include "core/files/plane_fit.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/must.h"

namespace arap {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A bar of 80 × 20 in steps of 10, each place p = (x, y) taken to space by `place`.
template <class Place>
SurfaceMesh Bar(Place place) {
  SurfaceMesh mesh;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 9; ++x) mesh.vertices.push_back(place(10.0 * x, 10.0 * y));
  }
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) {
      const std::uint32_t v = 9 * y + x;
      mesh.triangles.push_back({v, v + 1, v + 10});
      mesh.triangles.push_back({v, v + 10, v + 9});
    }
  }
  return mesh;
}

const PlanarMesh& FlatBar() {
  static const PlanarMesh bar = testing::Must(FitPlane(Bar([](double x, double y) {
                                  return Point3{x, y, 0};
                                }))).mesh;
  return bar;
}

TEST(PlaneFit, PlanesOfTheAxesAreTakenAsTheyAre) {
  const auto plain = testing::Must(FitPlane(Bar([](double x, double y) {
    return Point3{x, y, 7};
  })));
  EXPECT_THAT(plain.notes, IsEmpty());
  EXPECT_EQ(plain.mesh.vertices[26], Complex(80, 20));

  const auto xz = testing::Must(FitPlane(Bar([](double x, double y) { return Point3{x, -3, y}; })));
  EXPECT_EQ(xz.mesh, FlatBar());
  ASSERT_THAT(xz.notes, SizeIs(1));
  EXPECT_EQ(xz.notes[0].kind, "plane");
  EXPECT_THAT(xz.notes[0].message, HasSubstr("plane of x and z"));

  const auto yz = testing::Must(FitPlane(Bar([](double x, double y) { return Point3{0, x, y}; })));
  EXPECT_EQ(yz.mesh, FlatBar());
  EXPECT_THAT(yz.notes[0].message, HasSubstr("plane of y and z"));
}

TEST(PlaneFit, NoiseOfOneMillionthIsDroppedAndTold) {
  std::mt19937_64 random(1);
  const auto noise = [&] { return 2e-7 * (2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1); };
  const auto fit = testing::Must(FitPlane(Bar([&](double x, double y) {
    return Point3{x, y, noise()};
  })));
  EXPECT_EQ(fit.mesh, FlatBar());
  ASSERT_THAT(fit.notes, SizeIs(1));
  EXPECT_THAT(fit.notes[0].message, HasSubstr("z differs by "));
}

TEST(PlaneFit, AnyOtherPlaneKeepsItsLengths) {
  // Turned about the y axis by 30°, then about the x axis by 20°, far from the origin.
  const auto place = [](double x, double y) {
    const double c = std::cos(0.5236), s = std::sin(0.5236), k = std::cos(0.349),
                 l = std::sin(0.349);
    const double px = c * x, pz = -s * x;
    return Point3{100 + px, k * y - l * pz, -50 + l * y + k * pz};
  };
  const auto fit = testing::Must(FitPlane(Bar(place)));
  ASSERT_THAT(fit.notes, SizeIs(1));
  EXPECT_THAT(fit.notes[0].message, HasSubstr("lies in a plane across"));
  for (std::size_t a = 1; a < fit.mesh.vertices.size(); ++a) {
    const Complex one = fit.mesh.vertices[a] - fit.mesh.vertices[0];
    const Complex other = FlatBar().vertices[a] - FlatBar().vertices[0];
    EXPECT_NEAR(std::abs(one), std::abs(other), 1e-12) << a;
    // On the same side: not mirrored, and turned by less than a right angle.
    EXPECT_GT((one * std::conj(other)).real(), 0) << a;
  }
  const auto area = [](const PlanarMesh& mesh) {
    const auto at = [&](std::size_t v) { return mesh.vertices[v]; };
    return (std::conj(at(1) - at(0)) * (at(9) - at(0))).imag();
  };
  EXPECT_GT(area(fit.mesh), 0);
}

TEST(PlaneFit, WhatIsInNoPlaneIsRefused) {
  const auto bent = FitPlane(Bar([](double x, double y) {
    return Point3{x, y, x == 80 && y == 20 ? 1.0 : 0};
  }));
  ASSERT_FALSE(bent);
  EXPECT_EQ(bent.error().kind, FaultKind::kInvalidOption);
  EXPECT_THAT(bent.error().message, HasSubstr("not in a plane: vertex 26 at (80, 20, 1)"));
  EXPECT_EQ(bent.error().field, "mesh.vertices");
  EXPECT_THAT(bent.error().elements, ::testing::ElementsAre(26));
  const auto huge = FitPlane(Bar([](double x, double y) { return Point3{1e300 * x, y, x}; }));
  ASSERT_FALSE(huge);
  EXPECT_THAT(huge.error().message, HasSubstr("too large"));
}

}  // namespace
}  // namespace arap
