// Points of the plane.
#pragma once

#include <cmath>
#include <complex>

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

}  // namespace arap::cli
