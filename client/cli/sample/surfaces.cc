#include "client/cli/sample/surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "client/cli/sample/field.h"

namespace arap::cli {
namespace {

// The garment.

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

// The face.

constexpr double kWidth = 6.5, kHeight = 9, kDepth = 6.5;  // half axes of the head
constexpr double kOpening = 88 * std::numbers::pi / 180;   // from the nose to the rim
constexpr double kDiskRadius = 10;                         // of the disk that is bent over it

// 1 at the middle, falling off over `width` and `height`.
double Bump(Point p, Point middle, double width, double height) {
  const Point d = p - middle;
  return std::exp(-std::pow(d.real() / width, 2) - std::pow(d.imag() / height, 2));
}

// How far the face stands out at a place that is seen from the front.
double Relief(Point p) {
  const Point half(std::abs(p.real()), p.imag());
  double z = 2.6 * Bump(p, {0, -1.0}, 1.3, 1.1) + 1.4 * Bump(p, {0, 0.9}, 1.0, 1.6);  // nose
  z += 0.7 * Bump(half, {1.2, -1.5}, 0.8, 0.7);                                       // its wings
  z += -1.6 * Bump(half, {2.7, 1.4}, 1.5, 1.2);                                       // eye sockets
  z += 1.0 * Bump(half, {2.7, 1.2}, 0.9, 0.7);                                        // eyes
  z += 0.8 * Bump(half, {2.4, 3.1}, 2.2, 0.8);                                        // brows
  z += 0.8 * Bump(half, {3.6, -1.5}, 1.3, 1.4);                                       // cheeks
  z += 1.0 * Bump(p, {0, -4.0}, 1.9, 0.7) - 0.8 * Bump(p, {0, -5.3}, 2.0, 0.6);       // lips
  return z + 1.3 * Bump(p, {0, -6.9}, 1.8, 1.2);                                      // chin
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

SurfaceMesh MakeFace(double edge) {
  const PlanarMesh disk =
      MeshField([](Point p) { return Disk(p, 0, kDiskRadius); }, {kDiskRadius, 0}, edge);
  SurfaceMesh mesh;
  mesh.triangles = disk.triangles;
  for (const Point p : disk.vertices) {
    const double angle = std::abs(p) / kDiskRadius * kOpening;
    const Point toward = std::abs(p) > 0 ? p / std::abs(p) : 0;
    const Point front(kWidth * std::sin(angle) * toward.real(),
                      kHeight * std::sin(angle) * toward.imag());
    // The back of the rim has no features.
    const double z = kDepth * std::cos(angle) + std::max(0.0, std::cos(angle)) * Relief(front);
    const Point xy = Rounded(front);
    mesh.vertices.push_back({xy.real(), xy.imag(), Rounded({z, 0}).real()});
  }
  return mesh;
}

}  // namespace arap::cli
