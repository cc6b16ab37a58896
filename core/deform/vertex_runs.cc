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
double* NumbersOf(std::span<Complex> points) { return reinterpret_cast<double*>(points.data()); }

template <bool kAdd>
ARAP_WIDE_BODY void Map(const double* rest, std::size_t begin, std::size_t end, const Numbers& s,
                        double* shape) {
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    const double arm_x = rest[2 * v] - s.from_x, arm_y = rest[2 * v + 1] - s.from_y;
    const double px = s.place_x + (s.turn_x * arm_x - s.turn_y * arm_y);
    const double py = s.place_y + (s.turn_x * arm_y + s.turn_y * arm_x);
    shape[2 * v] = kAdd ? shape[2 * v] + px : px;
    shape[2 * v + 1] = kAdd ? shape[2 * v + 1] + py : py;
  }
}

ARAP_WIDE_BODY void SetBody(const double* rest, std::size_t begin, std::size_t end,
                            const Numbers& s, double* shape) {
  Map<false>(rest, begin, end, s, shape);
}
ARAP_WIDE_BODY void AddBody(const double* rest, std::size_t begin, std::size_t end,
                            const Numbers& s, double* shape) {
  Map<true>(rest, begin, end, s, shape);
}

ARAP_WIDE_BODY void ShiftBody(std::size_t begin, std::size_t end, double by_x, double by_y,
                              double* shape) {
  for (std::size_t v = begin; v < end; ++v) {
    shape[2 * v] += by_x;
    shape[2 * v + 1] += by_y;
  }
}

ARAP_WIDE_BODY void SumBody(const double* added, std::size_t n, double* values) {
#pragma GCC ivdep
  for (std::size_t v = 0; v < n; ++v) values[v] += added[v];
}

struct Units {
  double middle_x, middle_y, unit, origin_x, origin_y;
};

// `strange` counts numbers that are not finite.
ARAP_WIDE_BODY void ToUnitsBody(const double* shape, std::size_t begin, std::size_t end,
                                const Units& u, double* positions, std::int64_t& strange) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  std::int64_t count = 0;
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    const double px = u.origin_x + u.unit * (shape[2 * v] + u.middle_x);
    const double py = u.origin_y + u.unit * (shape[2 * v + 1] + u.middle_y);
    positions[2 * v] = px;
    positions[2 * v + 1] = py;
    count += std::abs(px) <= kLargest ? 0 : 1;
    count += std::abs(py) <= kLargest ? 0 : 1;
  }
  strange = count;
}

ARAP_WIDE(SetBody, SetWide,
          (const double* rest, std::size_t begin, std::size_t end, const Numbers& s, double* shape),
          (rest, begin, end, s, shape))
ARAP_WIDE(AddBody, AddWide,
          (const double* rest, std::size_t begin, std::size_t end, const Numbers& s, double* shape),
          (rest, begin, end, s, shape))
ARAP_WIDE(ShiftBody, ShiftWide,
          (std::size_t begin, std::size_t end, double by_x, double by_y, double* shape),
          (begin, end, by_x, by_y, shape))
ARAP_WIDE(SumBody, SumWide, (const double* added, std::size_t n, double* values),
          (added, n, values))
ARAP_WIDE(ToUnitsBody, ToUnitsWide,
          (const double* shape, std::size_t begin, std::size_t end, const Units& u,
           double* positions, std::int64_t& strange),
          (shape, begin, end, u, positions, strange))

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
                     const Similarity& similarity, std::span<Complex> shape) {
  (HasWide() ? SetWide : SetBody)(NumbersOf(rest), run.begin, run.end, NumbersOf(similarity),
                                  NumbersOf(shape));
}

void AddSimilarityOf(const VertexRun& run, std::span<const Complex> rest,
                     const Similarity& similarity, std::span<Complex> shape) {
  (HasWide() ? AddWide : AddBody)(NumbersOf(rest), run.begin, run.end, NumbersOf(similarity),
                                  NumbersOf(shape));
}

void Shift(const VertexRun& run, Complex by, std::span<Complex> shape) {
  (HasWide() ? ShiftWide : ShiftBody)(run.begin, run.end, by.real(), by.imag(), NumbersOf(shape));
}

void AddShape(std::span<const Complex> added, std::span<Complex> shape) {
  (HasWide() ? SumWide : SumBody)(NumbersOf(added), 2 * added.size(), NumbersOf(shape));
}

bool ToUnits(const VertexRun& run, std::span<const Complex> shape, Complex middle, double unit,
             Complex origin, std::span<Complex> positions) {
  std::int64_t strange = 0;
  (HasWide() ? ToUnitsWide : ToUnitsBody)(
      NumbersOf(shape), run.begin, run.end,
      {middle.real(), middle.imag(), unit, origin.real(), origin.imag()}, NumbersOf(positions),
      strange);
  return strange == 0;
}

}  // namespace arap
