#include "tests/support/compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/mesh/space.h"

namespace arap::testing {

double Diagonal(std::span<const Complex> points) {
  assert(!points.empty());
  double low_x = points[0].real(), high_x = low_x;
  double low_y = points[0].imag(), high_y = low_y;
  for (const Complex& p : points) {
    low_x = std::min(low_x, p.real());
    high_x = std::max(high_x, p.real());
    low_y = std::min(low_y, p.imag());
    high_y = std::max(high_y, p.imag());
  }
  return std::hypot(high_x - low_x, high_y - low_y);
}

double MaxDistance(std::span<const Complex> a, std::span<const Complex> b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double distance = std::abs(a[i] - b[i]);
    if (!std::isfinite(distance)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, distance);
  }
  return worst;
}

double RelativeDistance(std::span<const Complex> actual, std::span<const Complex> expected) {
  return MaxDistance(actual, expected) / Diagonal(expected);
}

Complex RigidMotion::operator()(Complex v) const { return std::polar(1.0, angle) * v + shift; }

std::vector<Complex> Apply(const RigidMotion& motion, std::span<const Complex> points) {
  std::vector<Complex> moved;
  moved.reserve(points.size());
  for (const Complex& p : points) moved.push_back(motion(p));
  return moved;
}

RigidMotion BestMotion(std::span<const Complex> from, std::span<const Complex> to) {
  assert(from.size() == to.size() && !from.empty());
  Complex from_centre, to_centre;
  for (const Complex& p : from) from_centre += p;
  for (const Complex& p : to) to_centre += p;
  from_centre /= static_cast<double>(from.size());
  to_centre /= static_cast<double>(to.size());
  Complex turn;
  for (std::size_t i = 0; i < from.size(); ++i) {
    turn += std::conj(from[i] - from_centre) * (to[i] - to_centre);
  }
  RigidMotion motion;
  motion.angle = std::arg(turn);
  motion.shift = to_centre - std::polar(1.0, motion.angle) * from_centre;
  return motion;
}

double RelativeDistanceUpToMotion(std::span<const Complex> actual,
                                  std::span<const Complex> expected) {
  return RelativeDistance(Apply(BestMotion(actual, expected), actual), expected);
}

double WorstEdge(const SurfaceMesh& mesh, std::span<const Complex> uv) {
  double worst = 0;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const double length = (Vec(mesh.vertices[a]) - Vec(mesh.vertices[b])).norm();
      worst = std::max(worst, std::abs(std::abs(uv[a] - uv[b]) / length - 1));
    }
  }
  return worst;
}

double SignedArea(const Triangle& triangle, std::span<const Complex> positions) {
  const Complex a = positions[triangle[1]] - positions[triangle[0]];
  const Complex b = positions[triangle[2]] - positions[triangle[0]];
  return 0.5 * (a.real() * b.imag() - a.imag() * b.real());
}

std::size_t CountFlipped(const std::vector<Triangle>& triangles,
                         std::span<const Complex> positions) {
  return static_cast<std::size_t>(
      std::count_if(triangles.begin(), triangles.end(),
                    [&](const Triangle& triangle) { return SignedArea(triangle, positions) < 0; }));
}

bool AllFinite(std::span<const Complex> points) {
  return std::all_of(points.begin(), points.end(), [](const Complex& p) {
    return std::isfinite(p.real()) && std::isfinite(p.imag());
  });
}

}  // namespace arap::testing
