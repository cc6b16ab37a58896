#include "core/deform/quality.h"

#include <algorithm>
#include <cmath>

namespace arap {
namespace {
constexpr double kMaxStretch = 1e30;
}

StretchTable::StretchTable(const PlanarMesh& mesh, const std::vector<Complex>& rest) {
  double total = 0;
  entries_.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const Complex e1 = rest[t[1]] - rest[t[0]], e2 = rest[t[2]] - rest[t[0]];
    const double twice_area = std::imag(std::conj(e1) * e2);
    const Complex d(0, -2 * twice_area);  // e1 ē2 − ē1 e2
    entries_.push_back({std::conj(e2) / d, -std::conj(e1) / d, twice_area});
    total += twice_area;
  }
  for (Entry& e : entries_) e.area /= total;
}

StretchTable::Stretch StretchTable::Measure(const PlanarMesh& mesh,
                                            std::span<const Complex> positions,
                                            double diagonal) const {
  Stretch stretch{0, 0, 1};
  const double unit = 1 / diagonal;
  for (std::size_t t = 0; t < entries_.size(); ++t) {
    const Triangle& c = mesh.triangles[t];
    const Complex e1 = positions[c[1]] - positions[c[0]], e2 = positions[c[2]] - positions[c[0]];
    const double twice_area = e1.real() * e2.imag() - e1.imag() * e2.real();
    if (twice_area < 0) ++stretch.flipped;
    const Entry& e = entries_[t];
    const Complex alpha = e.a1 * e1 + e.a2 * e2;
    const Complex beta = std::conj(e.a1) * e1 + std::conj(e.a2) * e2;
    const double big = std::sqrt(std::norm(alpha)) * unit,
                 small = std::sqrt(std::norm(beta)) * unit;
    const double s1 = big + small, s2 = std::abs(big - small);
    const double worst = std::min(kMaxStretch, s2 * s1 >= 1 ? s1 : 1 / s2);
    stretch.mean += e.area * worst;
    stretch.max = std::max(stretch.max, worst);
  }
  return stretch;
}

bool IsFlipped(const Triangle& triangle, std::span<const Complex> positions) {
  const Complex e1 = positions[triangle[1]] - positions[triangle[0]];
  const Complex e2 = positions[triangle[2]] - positions[triangle[0]];
  return e1.real() * e2.imag() - e1.imag() * e2.real() < 0;
}

}  // namespace arap
