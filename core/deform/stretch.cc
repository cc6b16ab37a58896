#include "core/deform/stretch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/lanes.h"
#include "core/base/plane.h"
#include "core/base/wide.h"

namespace arap {
namespace {

constexpr double kMaxStretch = 1e30;
constexpr std::size_t kBlock = 128;
using Column = std::array<double, kBlock>;

// What a block of triangles adds to the measure.
struct BlockStretch {
  std::int64_t flipped = 0;
  double sum = 0, max = 0;
};

template <std::size_t kMost>
ARAP_WIDE_BODY void MeasureBlock(const StretchTable::Columns& table, const Triangle* triangles,
                                 const double* positions, double unit, std::size_t begin,
                                 std::size_t count, BlockStretch& stretch) {
  Column e1x, e1y, e2x, e2y, worst, share;
  // Numbers of vertices stay far below 2^31 (MeshLimits).
  const auto* corners = reinterpret_cast<const std::int32_t*>(triangles[begin].data());
  GatherEdges<kMost, 3, PointsBy::kNumber>(positions, corners, {corners + 1, corners + 2}, count,
                                           {e1x.data(), e2x.data()}, {e1y.data(), e2y.data()});
  std::int64_t flipped = 0;
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t t = begin + k;
    const double a1x = table.a1_x[t], a1y = table.a1_y[t];
    const double a2x = table.a2_x[t], a2y = table.a2_y[t];
    const double ax = (a1x * e1x[k] - a1y * e1y[k]) + (a2x * e2x[k] - a2y * e2y[k]);
    const double ay = (a1x * e1y[k] + a1y * e1x[k]) + (a2x * e2y[k] + a2y * e2x[k]);
    const double bx = (a1x * e1x[k] + a1y * e1y[k]) + (a2x * e2x[k] + a2y * e2y[k]);
    const double by = (a1x * e1y[k] - a1y * e1x[k]) + (a2x * e2y[k] - a2y * e2x[k]);
    const double big = std::sqrt(ax * ax + ay * ay) * unit,
                 small = std::sqrt(bx * bx + by * by) * unit;
    const double s1 = big + small, s2 = std::abs(big - small);
    const double most = s2 * s1 >= 1 ? s1 : 1 / s2;
    worst[k] = most < kMaxStretch ? most : kMaxStretch;
    share[k] = table.area[t] * worst[k];
    flipped += e1x[k] * e2y[k] - e1y[k] * e2x[k] < 0 ? 1 : 0;
  }
  stretch.flipped = flipped;
  stretch.sum = SumOf(share.data(), count);
  stretch.max = LargestOf(worst.data(), count);
}

template <std::size_t kMost>
ARAP_WIDE_BODY void MeasureRange(const StretchTable::Columns& table, const Triangle* triangles,
                                 const double* positions, double unit, std::size_t begin,
                                 std::size_t end, BlockStretch& stretch) {
  for (; begin < end; begin += kBlock) {
    const std::size_t left = end - begin;
    BlockStretch block;
    MeasureBlock<kMost>(table, triangles, positions, unit, begin, left < kBlock ? left : kBlock,
                        block);
    stretch.flipped += block.flipped;
    stretch.sum += block.sum;
    stretch.max = block.max > stretch.max ? block.max : stretch.max;
  }
}

void MeasurePlain(const StretchTable::Columns& table, const Triangle* triangles,
                  const double* positions, double unit, std::size_t begin, std::size_t end,
                  BlockStretch& stretch) {
  MeasureRange<2>(table, triangles, positions, unit, begin, end, stretch);
}
ARAP_WIDE(MeasureRange<4>, MeasureWide,
          (const StretchTable::Columns& table, const Triangle* triangles, const double* positions,
           double unit, std::size_t begin, std::size_t end, BlockStretch& stretch),
          (table, triangles, positions, unit, begin, end, stretch))
ARAP_WIDEST(MeasureRange<8>, MeasureWidest,
            (const StretchTable::Columns& table, const Triangle* triangles, const double* positions,
             double unit, std::size_t begin, std::size_t end, BlockStretch& stretch),
            (table, triangles, positions, unit, begin, end, stretch))

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
                                            std::span<const Complex> positions, double diagonal,
                                            Crew* crew) const {
  constexpr std::size_t kLeast = std::size_t{1} << 15u;  // whole blocks
  // A complex number is two doubles in a row, says the standard.
  const auto* numbers = reinterpret_cast<const double*>(positions.data());
  const auto measure = HasWidest() ? MeasureWidest : HasWide() ? MeasureWide : MeasurePlain;
  const std::size_t count = mesh.triangles.size(), size = PartSize(count, kLeast);
  const std::size_t parts = (count + size - 1) / size;
  std::array<BlockStretch, kMostParts> stretches;
  RunParts(crew, parts, [&](std::size_t p) {
    stretches[p] = {};
    measure(columns_, mesh.triangles.data(), numbers, 1 / diagonal, p * size,
            std::min(count, (p + 1) * size), stretches[p]);
  });
  Stretch all{0, 0, 1};
  for (const BlockStretch& part : std::span(stretches).first(parts)) {
    all.flipped += static_cast<std::size_t>(part.flipped);
    all.mean += part.sum;
    all.max = std::max(all.max, part.max);
  }
  return all;
}

bool IsFlipped(const Triangle& triangle, std::span<const Complex> positions) {
  return TwiceArea(triangle, positions) < 0;
}

}  // namespace arap
