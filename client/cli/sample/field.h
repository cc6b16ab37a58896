// Points of the plane, and shapes as signed distance fields: negative inside, about the distance
// near the outline.
#pragma once

#include <cmath>
#include <complex>
#include <functional>

namespace arap::cli {

using Point = std::complex<double>;

// a × b: twice the signed area of the triangle 0, a, b.
inline double Cross(Point a, Point b) { return a.real() * b.imag() - a.imag() * b.real(); }

// Written coordinates have six decimals. Rounding here makes the mesh in memory the one in the
// file, and adding 0 turns -0 into 0.
inline Point Rounded(Point p) {
  constexpr double kUnit = 1e6;
  return {std::round(p.real() * kUnit) / kUnit + 0.0, std::round(p.imag() * kUnit) / kUnit + 0.0};
}

using Field = std::function<double(Point)>;

// A disk, and a capsule whose radius goes from `radius_a` at `a` to `radius_b` at `b`.
double Disk(Point p, Point center, double radius);
double Capsule(Point p, Point a, Point b, double radius_a, double radius_b);
// An ellipse along the axes.
double Ellipse(Point p, Point center, double radius_x, double radius_y);

// The union of two fields with its inner corners rounded over about `blend`.
double SmoothUnion(double a, double b, double blend);

// By central differences over `step`.
Point Gradient(const Field& field, Point p, double step);
// Moves `p` along the gradient to the outline.
Point Project(const Field& field, Point p, double step);

}  // namespace arap::cli
