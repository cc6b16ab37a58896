// Products of vectors of the plane.
#pragma once

#include <span>

#include "arap/model/mesh.h"

namespace arap {

// a × b: twice the signed area of the triangle 0, a, b; positive when b lies to the left of a.
inline double Cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }

// The scalar product.
inline double Dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

// Twice the signed area of a triangle; positive when it runs counter-clockwise.
inline double TwiceArea(Complex a, Complex b, Complex c) { return Cross(b - a, c - a); }
inline double TwiceArea(const Triangle& triangle, std::span<const Complex> vertices) {
  return TwiceArea(vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]);
}

}  // namespace arap
