// Lanes: a few doubles that are added and multiplied together, and pairs of them taken apart into lanes of x and lanes
// of y. For ARAP_WIDE_BODY functions (wide.h), which say how many a register holds.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/wide.h"

namespace arap {

// They lie anywhere a double may.
template <std::size_t kLanes>
struct LanesOf {
  // NOLINTNEXTLINE(modernize-use-using): attributes that depend on a parameter
  typedef double Type __attribute__((vector_size(kLanes * sizeof(double)), aligned(8), may_alias));
};
template <std::size_t kLanes>
using Lanes = typename LanesOf<kLanes>::Type;

// A point.
using Pair = Lanes<2>;

// The first and the second numbers of pairs.
ARAP_WIDE_BODY void Unzip(const Pair* pairs, Lanes<2>& x, Lanes<2>& y) {
  x = __builtin_shufflevector(pairs[0], pairs[1], 0, 2);
  y = __builtin_shufflevector(pairs[0], pairs[1], 1, 3);
}
ARAP_WIDE_BODY void Unzip(const Pair* pairs, Lanes<4>& x, Lanes<4>& y) {
  const Lanes<4> even = __builtin_shufflevector(pairs[0], pairs[2], 0, 1, 2, 3);
  const Lanes<4> odd = __builtin_shufflevector(pairs[1], pairs[3], 0, 1, 2, 3);
  x = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
  y = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
}
ARAP_WIDE_BODY void Unzip(const Pair* pairs, Lanes<8>& x, Lanes<8>& y) {
  Lanes<4> x0, x1, y0, y1;
  Unzip(pairs, x0, y0);
  Unzip(pairs + 4, x1, y1);
  x = __builtin_shufflevector(x0, x1, 0, 1, 2, 3, 4, 5, 6, 7);
  y = __builtin_shufflevector(y0, y1, 0, 1, 2, 3, 4, 5, 6, 7);
}

// How the points of a shape are named: by their number, or by where their two numbers begin, which is twice that and
// saves a shift for every load.
enum class PointsBy { kNumber, kBegin };

template <PointsBy kBy>
ARAP_WIDE_BODY const Pair& PointAt(const double* points, std::int32_t at) {
  constexpr std::size_t kApart = kBy == PointsBy::kNumber ? 2 : 1;
  return *reinterpret_cast<const Pair*>(points + kApart * static_cast<std::size_t>(at));
}
template <PointsBy kBy>
// NOLINTNEXTLINE(readability-non-const-parameter)
ARAP_WIDE_BODY Pair& PointAt(double* points, std::int32_t at) {
  constexpr std::size_t kApart = kBy == PointsBy::kNumber ? 2 : 1;
  return *reinterpret_cast<Pair*>(points + kApart * static_cast<std::size_t>(at));
}

// Points at[0], at[kStep], …: several loads of two numbers are faster than the processors' own gathering.
template <std::size_t kLanes, std::size_t kStep, PointsBy kBy>
ARAP_WIDE_BODY void Gather(const double* points, const std::int32_t* at, Lanes<kLanes>& x,
                           Lanes<kLanes>& y) {
  Pair pairs[kLanes];
#pragma GCC unroll 8
  for (std::size_t k = 0; k < kLanes; ++k) {
    pairs[k] = PointAt<kBy>(points, at[k * kStep]);
  }
  Unzip(pairs, x, y);
}

// Vectors from one point to several others, `count` times: x[e][k] := x of point to[e][k] − x of point from[k], and y
// alike. What names the points is kStep apart.
template <std::size_t kLanes, std::size_t kStep, PointsBy kBy, std::size_t kEdges>
ARAP_WIDE_BODY void GatherEdges(const double* points, const std::int32_t* from,
                                const std::int32_t* const (&to)[kEdges], std::size_t count,
                                double* const (&x)[kEdges], double* const (&y)[kEdges]) {
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    Lanes<kLanes> from_x, from_y;
    Gather<kLanes, kStep, kBy>(points, from + k * kStep, from_x, from_y);
#pragma GCC unroll 3
    for (std::size_t e = 0; e < kEdges; ++e) {
      Lanes<kLanes> to_x, to_y;
      Gather<kLanes, kStep, kBy>(points, to[e] + k * kStep, to_x, to_y);
      *reinterpret_cast<Lanes<kLanes>*>(x[e] + k) = to_x - from_x;
      *reinterpret_cast<Lanes<kLanes>*>(y[e] + k) = to_y - from_y;
    }
  }
  for (; k < count; ++k) {
    const Pair start = PointAt<kBy>(points, from[k * kStep]);
#pragma GCC unroll 3
    for (std::size_t e = 0; e < kEdges; ++e) {
      const Pair edge = PointAt<kBy>(points, to[e][k * kStep]) - start;
      x[e][k] = edge[0];
      y[e][k] = edge[1];
    }
  }
}

// Adds up in eight parts, whatever the registers hold.
ARAP_WIDE_BODY double SumOf(const double* values, std::size_t count) {
  double part[8]{};
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8) {
    for (std::size_t i = 0; i < 8; ++i) part[i] += values[k + i];
  }
  for (std::size_t i = 0; k < count; ++i, ++k) part[i] += values[k];
  return ((part[0] + part[4]) + (part[2] + part[6])) + ((part[1] + part[5]) + (part[3] + part[7]));
}

// The largest of `values`, at least 0.
ARAP_WIDE_BODY double LargestOf(const double* values, std::size_t count) {
  double part[8]{};
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8) {
    for (std::size_t i = 0; i < 8; ++i) {
      part[i] = values[k + i] > part[i] ? values[k + i] : part[i];
    }
  }
  for (std::size_t i = 0; k < count; ++i, ++k) part[i] = values[k] > part[i] ? values[k] : part[i];
  double largest = 0;
  for (const double value : part) largest = value > largest ? value : largest;
  return largest;
}

}  // namespace arap
