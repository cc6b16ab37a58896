// Strain as a colour: blue compressed, white unchanged, red stretched.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>

#include "arap/model/mesh.h"
#include "core/drawing/svg.h"

namespace arap {

// The strain of a triangle in percent: of the two principal strains s1 − 1 and s2 − 1 the one that
// is farther from 0. Negative is compression.
double PrincipalStrainPercent(double s1, double s2);

// The largest absolute strain over triangles with s1 and s2; those that are not finite and those
// that were left out (0 0) do not count.
double LargestStrainPercent(std::span<const std::array<double, 2>> singular_values);

// 1, 2 or 5 times a power of ten, at least `percent` and at least 1e-6: the end of a colour scale.
double StrainRange(double percent);

inline constexpr int kStrainShades = 24;  // on each side of white

// From −kStrainShades (blue) to kStrainShades (red).
std::string StrainColor(int shade);

// The triangles of each shade, as lines for a path. Without singular values all are white.
std::map<int, Lines> TrianglesByShade(std::span<const Triangle> triangles,
                                      std::span<const std::array<double, 2>> singular_values,
                                      double range);

}  // namespace arap
