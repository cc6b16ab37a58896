#include "client/cli/sample/garment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "client/cli/sample/point.h"

namespace arap::cli {
namespace {

constexpr double kLength = 55;  // waist to hem
constexpr double kWaistRadius = 11.5;
constexpr double kHipBulge = 3.0;                       // round the hip, a quarter down
constexpr double kFlare = 9.0;                          // more radius at the hem
constexpr double kFoldDepth = 1.3;                      // of the folds at the hem
constexpr double kFolds = 4;                            // over the panel
constexpr double kHalfAngle = 0.46 * std::numbers::pi;  // a little less than the front half
constexpr double kWaistDip = 2.0;                       // the waistline drops towards the middle
constexpr double kDepthOverWidth = 0.8;                 // a body is wider than deep

// u from -1 (left seam) to 1 (right seam), v from 0 (hem) to 1 (waist).
Point3 Surface(double u, double v) {
  const double down = 1 - v;
  const double hip = kHipBulge * std::exp(-std::pow((down - 0.28) / 0.2, 2));
  const double folds = kFoldDepth * down * down * std::cos(kFolds * std::numbers::pi * u);
  const double radius = kWaistRadius + hip + kFlare * down + folds;
  const double angle = kHalfAngle * u;
  const double dip = kWaistDip * v * (1 - u * u);
  return {radius * std::sin(angle), v * kLength - dip, kDepthOverWidth * radius * std::cos(angle)};
}

}  // namespace

SurfaceMesh MakeGarment(double edge) {
  constexpr double kMeanRadius = kWaistRadius + kFlare / 2 + 1;
  const auto columns = static_cast<std::size_t>(std::lround(2 * kHalfAngle * kMeanRadius / edge));
  const auto rows =
      static_cast<std::size_t>(std::lround(kLength / (edge * std::numbers::sqrt3 / 2)));
  SurfaceMesh mesh;
  for (std::size_t y = 0; y <= rows; ++y) {
    for (std::size_t x = 0; x <= columns; ++x) {
      // Every other row is shifted by half an edge, but not at the seams.
      const double shift = y % 2 == 1 && x > 0 && x < columns ? 0.25 : -0.25;
      const double inner = x > 0 && x < columns ? shift : 0;
      const double u = 2 * (static_cast<double>(x) + inner) / static_cast<double>(columns) - 1;
      Point3& p = mesh.vertices.emplace_back(
          Surface(u, static_cast<double>(y) / static_cast<double>(rows)));
      for (double& coordinate : p) coordinate = Rounded({coordinate, 0}).real();
    }
  }
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < columns; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x);
      const std::uint32_t b = a + 1;
      const auto d = static_cast<std::uint32_t>(a + columns + 1);
      const std::uint32_t c = d + 1;
      // The diagonal that the shift has made the shorter one.
      if (y % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      }
    }
  }
  return mesh;
}

}  // namespace arap::cli
