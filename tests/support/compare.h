// How far two shapes are apart, rigid motions, and an independent count of flipped triangles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::testing {

// Diagonal of the bounding box.
double Diagonal(std::span<const Complex> points);

// Largest distance between points of the same index. The sizes must agree; NaN anywhere gives
// infinity.
double MaxDistance(std::span<const Complex> a, std::span<const Complex> b);

// MaxDistance over the diagonal of `expected`.
double RelativeDistance(std::span<const Complex> actual, std::span<const Complex> expected);

// v ↦ e^{i·angle} v + shift.
struct RigidMotion {
  double angle = 0;
  Complex shift;
  Complex operator()(Complex v) const;
};
std::vector<Complex> Apply(const RigidMotion& motion, std::span<const Complex> points);

// The motion that brings `from` closest to `to` in the least-squares sense.
RigidMotion BestMotion(std::span<const Complex> from, std::span<const Complex> to);

// RelativeDistance after the best rigid motion: for flat shapes, whose placing in the plane is
// free.
double RelativeDistanceUpToMotion(std::span<const Complex> actual,
                                  std::span<const Complex> expected);

// Largest relative change of an edge length from the surface to the plane.
double WorstEdge(const SurfaceMesh& mesh, std::span<const Complex> uv);

double SignedArea(const Triangle& triangle, std::span<const Complex> positions);

// Triangles of negative signed area.
std::size_t CountFlipped(const std::vector<Triangle>& triangles,
                         std::span<const Complex> positions);

bool AllFinite(std::span<const Complex> points);

}  // namespace arap::testing
