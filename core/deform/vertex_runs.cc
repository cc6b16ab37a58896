#include "core/deform/vertex_runs.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/wide.h"

namespace arap {
namespace {

struct Numbers {
  double from_x, from_y, place_x, place_y, turn_x, turn_y;
};

Numbers NumbersOf(const Similarity& s) {
  return {s.from.real(),  s.from.imag(), s.place.real(),
          s.place.imag(), s.turn.real(), s.turn.imag()};
}

// A complex number is two doubles in a row, says the standard.
const double* NumbersOf(std::span<const Complex> points) {
  return reinterpret_cast<const double*>(points.data());
}

template <bool kAdd>
ARAP_WIDE_BODY void Map(const double* rest, std::size_t begin, std::size_t end, const Numbers& s,
                        double* x, double* y) {
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    const double arm_x = rest[2 * v] - s.from_x, arm_y = rest[2 * v + 1] - s.from_y;
    const double px = s.place_x + (s.turn_x * arm_x - s.turn_y * arm_y);
    const double py = s.place_y + (s.turn_x * arm_y + s.turn_y * arm_x);
    x[v] = kAdd ? x[v] + px : px;
    y[v] = kAdd ? y[v] + py : py;
  }
}

ARAP_WIDE_BODY void SetBody(const double* rest, std::size_t begin, std::size_t end,
                            const Numbers& s, double* x, double* y) {
  Map<false>(rest, begin, end, s, x, y);
}
ARAP_WIDE_BODY void AddBody(const double* rest, std::size_t begin, std::size_t end,
                            const Numbers& s, double* x, double* y) {
  Map<true>(rest, begin, end, s, x, y);
}

ARAP_WIDE_BODY void ShiftBody(std::size_t begin, std::size_t end, double by, double* values) {
  for (std::size_t v = begin; v < end; ++v) values[v] += by;
}

ARAP_WIDE_BODY void SumBody(const double* added, std::size_t n, double* values) {
#pragma GCC ivdep
  for (std::size_t v = 0; v < n; ++v) values[v] += added[v];
}

struct Units {
  double middle_x, middle_y, unit, origin_x, origin_y;
};

// `strange` counts numbers that are not finite.
ARAP_WIDE_BODY void ToUnitsBody(const double* x, const double* y, std::size_t begin,
                                std::size_t end, const Units& u, double* positions,
                                std::int64_t& strange) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  std::int64_t count = 0;
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    const double px = u.origin_x + u.unit * (x[v] + u.middle_x);
    const double py = u.origin_y + u.unit * (y[v] + u.middle_y);
    positions[2 * v] = px;
    positions[2 * v + 1] = py;
    count += std::abs(px) <= kLargest ? 0 : 1;
    count += std::abs(py) <= kLargest ? 0 : 1;
  }
  strange = count;
}

ARAP_WIDE(SetBody, SetWide,
          (const double* rest, std::size_t begin, std::size_t end, const Numbers& s, double* x,
           double* y),
          (rest, begin, end, s, x, y))
ARAP_WIDE(AddBody, AddWide,
          (const double* rest, std::size_t begin, std::size_t end, const Numbers& s, double* x,
           double* y),
          (rest, begin, end, s, x, y))
ARAP_WIDE(ShiftBody, ShiftWide, (std::size_t begin, std::size_t end, double by, double* values),
          (begin, end, by, values))
ARAP_WIDE(SumBody, SumWide, (const double* added, std::size_t n, double* values),
          (added, n, values))
ARAP_WIDE(ToUnitsBody, ToUnitsWide,
          (const double* x, const double* y, std::size_t begin, std::size_t end, const Units& u,
           double* positions, std::int64_t& strange),
          (x, y, begin, end, u, positions, strange))

}  // namespace

std::vector<VertexRun> RunsOf(std::span<const std::uint32_t> component) {
  std::vector<VertexRun> runs;
  for (std::uint32_t v = 0; v < component.size(); ++v) {
    if (runs.empty() || runs.back().component != component[v]) runs.push_back({v, v, component[v]});
    runs.back().end = v + 1;
  }
  runs.shrink_to_fit();
  return runs;
}

void SetToSimilarity(const VertexRun& run, std::span<const Complex> rest,
                     const Similarity& similarity, ShapeView shape) {
  (HasWide() ? SetWide : SetBody)(NumbersOf(rest), run.begin, run.end, NumbersOf(similarity),
                                  shape.x, shape.y);
}

void AddSimilarityOf(const VertexRun& run, std::span<const Complex> rest,
                     const Similarity& similarity, ShapeView shape) {
  (HasWide() ? AddWide : AddBody)(NumbersOf(rest), run.begin, run.end, NumbersOf(similarity),
                                  shape.x, shape.y);
}

void Shift(const VertexRun& run, Complex by, ShapeView shape) {
  const auto shift = HasWide() ? ShiftWide : ShiftBody;
  shift(run.begin, run.end, by.real(), shape.x);
  shift(run.begin, run.end, by.imag(), shape.y);
}

void AddShape(const double* x, const double* y, std::size_t n, ShapeView shape) {
  const auto add = HasWide() ? SumWide : SumBody;
  add(x, n, shape.x);
  add(y, n, shape.y);
}

bool ToUnits(const VertexRun& run, ConstShapeView shape, Complex middle, double unit,
             Complex origin, std::span<Complex> positions) {
  std::int64_t strange = 0;
  (HasWide() ? ToUnitsWide : ToUnitsBody)(
      shape.x, shape.y, run.begin, run.end,
      {middle.real(), middle.imag(), unit, origin.real(), origin.imag()},
      reinterpret_cast<double*>(positions.data()), strange);
  return strange == 0;
}

}  // namespace arap
