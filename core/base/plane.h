// The plane: products of its vectors, closed curves, and the box round them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// a × b: twice the signed area of the triangle 0, a, b; positive when b lies to the left of a.
inline double Cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }

inline bool IsFinite(Complex point) {
  return std::isfinite(point.real()) && std::isfinite(point.imag());
}

// The scalar product.
inline double Dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

// Twice the signed area of a triangle; positive when it runs counter-clockwise.
inline double TwiceArea(Complex a, Complex b, Complex c) { return Cross(b - a, c - a); }
inline double TwiceArea(const Triangle& triangle, std::span<const Complex> vertices) {
  return TwiceArea(vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]);
}

// A closed curve; the first point is not repeated.
using Ring = std::vector<Complex>;

// The smallest box round everything that it was shown.
struct Bounds {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  bool empty = true;

  // A point that is not finite is passed over.
  void Add(Complex point) {
    if (!IsFinite(point)) return;
    const double x = point.real(), y = point.imag();
    if (empty) {
      *this = {x, y, x, y, false};
      return;
    }
    min_x = std::min(min_x, x);
    min_y = std::min(min_y, y);
    max_x = std::max(max_x, x);
    max_y = std::max(max_y, y);
  }
  void Add(std::span<const Complex> points) {
    for (const Complex point : points) Add(point);
  }
  Bounds Moved(Complex by) const {
    if (empty) return *this;
    return {min_x + by.real(), min_y + by.imag(), max_x + by.real(), max_y + by.imag(), false};
  }
  double width() const { return max_x - min_x; }
  double height() const { return max_y - min_y; }
  double diagonal() const { return std::hypot(width(), height()); }
  Complex center() const { return {0.5 * (min_x + max_x), 0.5 * (min_y + max_y)}; }
};

// Round the corners of triangles.
inline Bounds BoundsOf(std::span<const Complex> points, std::span<const Triangle> triangles) {
  Bounds bounds;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) bounds.Add(points[v]);
  }
  return bounds;
}
inline double DiagonalOf(std::span<const Complex> points, std::span<const Triangle> triangles) {
  return BoundsOf(points, triangles).diagonal();
}

}  // namespace arap
