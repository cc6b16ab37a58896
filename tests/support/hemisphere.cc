#include "tests/support/hemisphere.h"

#include <array>
#include <cmath>
#include <numbers>

namespace arap::testing {
namespace {

// Three Gauss points: place in [0, 1] and weight. None falls on the pole.
const std::array<std::array<double, 2>, 3> kGauss{
    {{0.5 - std::sqrt(0.15), 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + std::sqrt(0.15), 5.0 / 18}}};

// Calls visit(element, place in it, sin θ, weight sin θ dθ) for every Gauss point.
template <class Visit>
void Integrate(std::size_t elements, Visit visit) {
  const double h = 0.5 * std::numbers::pi / static_cast<double>(elements);
  for (std::size_t k = 0; k < elements; ++k) {
    for (const auto& [place, weight] : kGauss) {
      const double sine = std::sin(h * (static_cast<double>(k) + place));
      visit(k, place, sine, weight * h * sine);
    }
  }
}

}  // namespace

FlatHemisphere FlattenHemisphere(std::size_t elements) {
  const double h = 0.5 * std::numbers::pi / static_cast<double>(elements);
  // Normal equations for r_1 … r_n; r_0 = 0. `above[k]` couples k and k + 1.
  std::vector<double> diagonal(elements + 1, 0.0), above(elements + 1, 0.0),
      right(elements + 1, 0.0);
  Integrate(elements, [&](std::size_t k, double place, double sine, double weight) {
    // Both strains are linear in (r_k, r_k+1), with 1 as their targets.
    const std::array<std::array<double, 2>, 2> rows{
        {{-1 / h, 1 / h}, {(1 - place) / sine, place / sine}}};
    for (const auto& [a, b] : rows) {
      diagonal[k] += weight * a * a;
      diagonal[k + 1] += weight * b * b;
      above[k] += weight * a * b;
      right[k] += weight * a;
      right[k + 1] += weight * b;
    }
  });
  for (std::size_t k = 2; k <= elements; ++k) {
    const double factor = above[k - 1] / diagonal[k - 1];
    diagonal[k] -= factor * above[k - 1];
    right[k] -= factor * right[k - 1];
  }
  FlatHemisphere flat;
  std::vector<double>& r = flat.radius;
  r.assign(elements + 1, 0.0);
  r[elements] = right[elements] / diagonal[elements];
  for (std::size_t k = elements; k-- > 1;) r[k] = (right[k] - above[k] * r[k + 1]) / diagonal[k];
  Integrate(elements, [&](std::size_t k, double place, double sine, double weight) {
    const double along = (r[k + 1] - r[k]) / h - 1;
    const double around = ((1 - place) * r[k] + place * r[k + 1]) / sine - 1;
    flat.arap_energy += weight * (along * along + around * around);
  });
  return flat;
}

}  // namespace arap::testing
