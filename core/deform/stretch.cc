#include "core/deform/stretch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/plane.h"
#include "core/base/wide.h"

namespace arap {
namespace {

constexpr double kMaxStretch = 1e30;
constexpr std::size_t kBlock = 256;
using Column = std::array<double, kBlock>;

// Of triangles begin…: max(s1, 1/s2), and twice the signed area.
ARAP_WIDE_BODY void MeasureBlock(const StretchTable::Columns& table, const Triangle* triangles,
                                 const double* positions, double unit, std::size_t begin,
                                 std::size_t count, Column& worst, Column& twice_area) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t t = begin + k;
    // Signed numbers, because the wide loads want signed offsets.
    const auto i = static_cast<std::int32_t>(triangles[t][0]),
               j = static_cast<std::int32_t>(triangles[t][1]),
               l = static_cast<std::int32_t>(triangles[t][2]);
    const double px = positions[2 * i], py = positions[2 * i + 1];
    const double e1x = positions[2 * j] - px, e1y = positions[2 * j + 1] - py;
    const double e2x = positions[2 * l] - px, e2y = positions[2 * l + 1] - py;
    const double a1x = table.a1_x[t], a1y = table.a1_y[t];
    const double a2x = table.a2_x[t], a2y = table.a2_y[t];
    const double ax = (a1x * e1x - a1y * e1y) + (a2x * e2x - a2y * e2y);
    const double ay = (a1x * e1y + a1y * e1x) + (a2x * e2y + a2y * e2x);
    const double bx = (a1x * e1x + a1y * e1y) + (a2x * e2x + a2y * e2y);
    const double by = (a1x * e1y - a1y * e1x) + (a2x * e2y - a2y * e2x);
    const double big = std::sqrt(ax * ax + ay * ay) * unit,
                 small = std::sqrt(bx * bx + by * by) * unit;
    const double s1 = big + small, s2 = std::abs(big - small);
    const double most = s2 * s1 >= 1 ? s1 : 1 / s2;
    worst[k] = most < kMaxStretch ? most : kMaxStretch;
    twice_area[k] = e1x * e2y - e1y * e2x;
  }
}

ARAP_WIDE(MeasureBlock, MeasureBlockWide,
          (const StretchTable::Columns& table, const Triangle* triangles, const double* positions,
           double unit, std::size_t begin, std::size_t count, Column& worst, Column& twice_area),
          (table, triangles, positions, unit, begin, count, worst, twice_area))

}  // namespace

StretchTable::StretchTable(const PlanarMesh& mesh, const std::vector<Complex>& rest) {
  double total = 0;
  Columns& c = columns_;
  for (auto* column : {&c.a1_x, &c.a1_y, &c.a2_x, &c.a2_y, &c.area}) {
    column->reserve(mesh.triangles.size());
  }
  for (const Triangle& t : mesh.triangles) {
    const Complex e1 = rest[t[1]] - rest[t[0]], e2 = rest[t[2]] - rest[t[0]];
    const double twice_area = Cross(e1, e2);
    const Complex d(0, -2 * twice_area);  // e1 ē2 − ē1 e2
    const Complex a1 = std::conj(e2) / d, a2 = -std::conj(e1) / d;
    c.a1_x.push_back(a1.real());
    c.a1_y.push_back(a1.imag());
    c.a2_x.push_back(a2.real());
    c.a2_y.push_back(a2.imag());
    c.area.push_back(twice_area);
    total += twice_area;
  }
  for (double& area : c.area) area /= total;
}

StretchTable::Stretch StretchTable::Measure(const PlanarMesh& mesh,
                                            std::span<const Complex> positions,
                                            double diagonal) const {
  Stretch stretch{0, 0, 1};
  Column worst, twice_area;
  // A complex number is two doubles in a row, says the standard.
  const auto* numbers = reinterpret_cast<const double*>(positions.data());
  for (std::size_t begin = 0; begin < columns_.area.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, columns_.area.size() - begin);
    (HasWide() ? MeasureBlockWide : MeasureBlock)(columns_, mesh.triangles.data(), numbers,
                                                  1 / diagonal, begin, count, worst, twice_area);
    for (std::size_t k = 0; k < count; ++k) {
      if (twice_area[k] < 0) ++stretch.flipped;
      stretch.mean += columns_.area[begin + k] * worst[k];
      stretch.max = std::max(stretch.max, worst[k]);
    }
  }
  return stretch;
}

bool IsFlipped(const Triangle& triangle, std::span<const Complex> positions) {
  return TwiceArea(triangle, positions) < 0;
}

}  // namespace arap
