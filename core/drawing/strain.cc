#include "core/drawing/strain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace arap {
namespace {

// Of triangle t; 0 when it was left out or nothing is known.
double StrainOf(std::span<const std::array<double, 2>> singular_values, std::size_t t) {
  if (t >= singular_values.size()) return 0;
  const auto [s1, s2] = singular_values[t];
  return s1 == 0 && s2 == 0 ? 0 : PrincipalStrainPercent(s1, s2);
}

}  // namespace

double PrincipalStrainPercent(double s1, double s2) {
  const double stretch = s1 - 1;
  const double compression = s2 - 1;
  return 100 * (std::abs(stretch) >= std::abs(compression) ? stretch : compression);
}

double LargestStrainPercent(std::span<const std::array<double, 2>> singular_values) {
  double largest = 0;
  for (std::size_t t = 0; t < singular_values.size(); ++t) {
    const double strain = StrainOf(singular_values, t);
    if (std::isfinite(strain)) largest = std::max(largest, std::abs(strain));
  }
  return largest;
}

double StrainRange(double percent) {
  constexpr double kSmallest = 1e-6;
  constexpr double kRounding = 1e-9;  // 100 · (1.02 − 1) is a little more than 2
  percent = std::max(percent * (1 - kRounding), kSmallest);
  const double power = std::pow(10, std::floor(std::log10(percent)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= percent) return factor * power;
  }
  return 10 * power;
}

std::string StrainColor(int shade) {
  constexpr std::array<double, 3> kBlue{33, 102, 172}, kWhite{250, 250, 250}, kRed{178, 24, 43};
  const auto& end = shade < 0 ? kBlue : kRed;
  const double t = std::sqrt(std::abs(shade) / static_cast<double>(kStrainShades));
  std::array<int, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb[i] = static_cast<int>(std::lround(std::lerp(kWhite[i], end[i], t)));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::map<int, Lines> TrianglesByShade(std::span<const Triangle> triangles,
                                      std::span<const std::array<double, 2>> singular_values,
                                      double range) {
  std::map<int, Lines> by_shade;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double strain = StrainOf(singular_values, t);
    const double share = std::isfinite(strain) ? std::clamp(strain / range, -1.0, 1.0) : 1.0;
    by_shade[static_cast<int>(std::lround(share * kStrainShades))].emplace_back(
        triangles[t].begin(), triangles[t].end());
  }
  return by_shade;
}

}  // namespace arap
