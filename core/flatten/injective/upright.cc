#include "core/flatten/injective/upright.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/mesh/plane.h"

namespace arap {

bool Upright(Complex a, Complex b, Complex c) {
  const Complex u = b - a, v = c - a;
  const double cross = Cross(u, v);
  const auto reach = [](Complex z) { return std::max(std::abs(z.real()), std::abs(z.imag())); };
  const double coordinate = std::max({reach(a), reach(b), reach(c)});
  const double length = std::max(reach(u), reach(v));
  return cross > 4 * std::numeric_limits<double>::epsilon() * coordinate * length &&
         std::isfinite(cross);
}

std::vector<std::uint32_t> NotUpright(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& left_out) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!left_out.empty() && left_out[t]) continue;
    const auto& [a, b, c] = triangles[t];
    if (!Upright(uv[a], uv[b], uv[c])) result.push_back(t);
  }
  return result;
}

std::vector<std::uint32_t> WoundTwice(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& boundary,
                                      const std::vector<bool>& left_out) {
  std::vector<double> around(uv.size(), 0);
  std::vector<bool> open = boundary;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k];
      if (!left_out.empty() && left_out[t]) {
        open[v] = true;
        continue;
      }
      const Complex u = uv[triangles[t][(k + 1) % 3]] - uv[v];
      const Complex w = uv[triangles[t][(k + 2) % 3]] - uv[v];
      around[v] += std::arg(std::conj(u) * w);
    }
  }
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < uv.size(); ++v) {
    if (!open[v] && around[v] > 3 * std::numbers::pi) result.push_back(v);
  }
  return result;
}

}  // namespace arap
