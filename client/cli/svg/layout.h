// The picture of a flat surface.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace arap::cli {

struct Layout {
  std::span<const double> uv;                // u v u v…, length 2·#U
  std::span<const std::uint32_t> triangles;  // into uv, length 3·#F
  std::span<const double> singular_values;   // s1 s2 s1 s2…, length 2·#F
  std::vector<std::string> caption;          // lines
};

// The strain of a triangle in percent: of the two principal strains s1 − 1 and s2 − 1 the one that
// is farther from 0. Negative is compression.
double PrincipalStrainPercent(double s1, double s2);

// The triangles coloured by that strain (blue compressed, white unchanged, red stretched) with a
// legend, and the outline emphasised.
std::string FormatLayout(const Layout& layout);

}  // namespace arap::cli
