// Shapes of the plane as signed distance fields (negative inside, about the distance near the
// outline), and their triangles.
#pragma once

#include <cmath>
#include <functional>

#include "arap/model/mesh.h"

namespace arap::cli {

using Point = Complex;

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

// Well-shaped counter-clockwise triangles inside a field with edges about `edge` long, without loose
// vertices. `start` is a point near the outline, which has to be smooth over that length, and in one
// piece.
PlanarMesh MeshField(const Field& field, Point start, double edge);

}  // namespace arap::cli
