#include "core/outline/asked.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

namespace arap {

std::size_t PointsOf(std::span<const Outline> outlines) {
  std::size_t points = 0;
  for (const Outline& outline : outlines) points += outline.size();
  return points;
}

Status CheckOutlines(std::span<const Outline> outlines) {
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    if (outlines[i].size() < 3) {
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("Outline {} has {} points: at least 3 bound a region.", i,
                                    outlines[i].size()))
                      .Element(id));
    }
    for (const Complex p : outlines[i]) {
      constexpr double kLargest = 1e15;  // their products are finite, and differences have digits
      if (!(std::abs(p.real()) <= kLargest && std::abs(p.imag()) <= kLargest)) {
        return Fail(
            Fault(FaultKind::kNonFiniteCoordinate,
                  fmt::format("Outline {} has a point that is not finite or beyond 1e15.", i))
                .Element(id));
      }
    }
  }
  if (const std::size_t points = PointsOf(outlines); points > kMaxOutlinePoints) {
    return Fail(Fault(FaultKind::kLimitExceeded,
                      fmt::format("The outlines have {} points: the limit is {}.", points,
                                  kMaxOutlinePoints))
                    .Detail("limit", kMaxOutlinePoints));
  }
  return {};
}

Status CheckAsked(std::span<const Outline> outlines, std::size_t vertices) {
  if (vertices < 1 || vertices > kMaxAskedVertices) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("A mesh of {} vertices was asked for: from 1 to {} can be made.",
                                  vertices, kMaxAskedVertices))
                    .Detail("limit", kMaxAskedVertices));
  }
  return CheckOutlines(outlines);
}

Complex OriginOf(std::span<const Outline> outlines) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::array<double, 2> low{kInfinite, kInfinite}, high{-kInfinite, -kInfinite}, origin{};
  for (const Outline& outline : outlines) {
    for (const Complex p : outline) {
      low = {std::min(low[0], p.real()), std::min(low[1], p.imag())};
      high = {std::max(high[0], p.real()), std::max(high[1], p.imag())};
    }
  }
  if (PointsOf(outlines) == 0) return 0;
  constexpr double kFar = 16;
  const double size = std::max(high[0] - low[0], high[1] - low[1]);
  for (std::size_t k = 0; k < 2; ++k) {
    if (low[k] > kFar * size || high[k] < -kFar * size) origin[k] = low[k];
  }
  return {origin[0], origin[1]};
}

std::vector<Outline> CountedFrom(Complex origin, std::span<const Outline> outlines) {
  std::vector<Outline> moved(outlines.begin(), outlines.end());
  for (Outline& outline : moved) {
    for (Complex& p : outline) p -= origin;
  }
  return moved;
}

MeshingCost EstimateMeshing(std::size_t points, std::size_t vertices, std::size_t most) {
  // Measured; a point of an outline needs a vertex, and often another one near it.
  const double likely = static_cast<double>(std::min(vertices + 2 * points, most + points));
  return {25e-6 * likely, 1000 * most};
}

}  // namespace arap
