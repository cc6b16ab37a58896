#include "client/cli/sample/face.h"

#include <cmath>
#include <numbers>

#include "client/cli/sample/field.h"
#include "client/cli/sample/mesher.h"
#include "client/cli/sample/point.h"

namespace arap::cli {
namespace {

constexpr double kWidth = 6.5, kHeight = 9, kDepth = 6.5;  // half axes of the head
constexpr double kOpening = 88 * std::numbers::pi / 180;   // from the nose to the rim
constexpr double kRadius = 10;                             // of the disk that is bent over it

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

SurfaceMesh MakeFace(double edge) {
  const PlanarMesh disk =
      MeshField([](Point p) { return Disk(p, 0, kRadius); }, {kRadius, 0}, edge);
  SurfaceMesh mesh;
  mesh.triangles = disk.triangles;
  for (const Point p : disk.vertices) {
    const double angle = std::abs(p) / kRadius * kOpening;
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
