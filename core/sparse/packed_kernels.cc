#include "core/sparse/packed_kernels.h"

#include "core/base/lanes.h"
#include "core/base/wide.h"

namespace arap {
namespace {

// One row of x.
// NOLINTBEGIN(readability-non-const-parameter)
template <std::size_t kLanes>
ARAP_WIDE_BODY Lanes<kLanes>& At(double* x, std::size_t row) {
  return *reinterpret_cast<Lanes<kLanes>*>(x + row * kLanes);
}
// NOLINTEND(readability-non-const-parameter)

// Whether all of `count` numbers are 0.
ARAP_WIDE_BODY bool IsZero(const double* x, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    if (x[k] != 0) return false;
  }
  return true;
}

// Real factors. The lanes of a register are the columns of a panel. A right-hand side is a pair of numbers (x and y of a
// shape), and kPairs of them are solved together.

// kLanes neighbouring numbers of a factor.
template <std::size_t kLanes>
ARAP_WIDE_BODY const Lanes<kLanes>& NumbersFrom(const double* m) {
  return *reinterpret_cast<const Lanes<kLanes>*>(m);
}

// The sums of all x and of all y as a pair: halves onto one another down to four numbers, then neighbours.
ARAP_WIDE_BODY void Fold(const Lanes<2>& x, const Lanes<2>& y, Pair& sum) {
  sum = __builtin_shufflevector(x, y, 0, 2) + __builtin_shufflevector(x, y, 1, 3);
}
ARAP_WIDE_BODY void Fold(const Lanes<2> (&x)[2], const Lanes<2> (&y)[2], Pair& sum) {
  Pair low, high;
  Fold(x[0], y[0], low);
  Fold(x[1], y[1], high);
  sum = low + high;
}
ARAP_WIDE_BODY void Fold(const Lanes<2> (&x)[4], const Lanes<2> (&y)[4], Pair& sum) {
  const Lanes<2> half_x[2] = {x[0] + x[2], x[1] + x[3]}, half_y[2] = {y[0] + y[2], y[1] + y[3]};
  Fold(half_x, half_y, sum);
}
ARAP_WIDE_BODY void Fold(const Lanes<4> (&x)[1], const Lanes<4> (&y)[1], Pair& sum) {
  const Lanes<4> both = __builtin_shufflevector(x[0], y[0], 0, 4, 2, 6) +
                        __builtin_shufflevector(x[0], y[0], 1, 5, 3, 7);
  sum = __builtin_shufflevector(both, both, 0, 1) + __builtin_shufflevector(both, both, 2, 3);
}
ARAP_WIDE_BODY void Fold(const Lanes<4> (&x)[2], const Lanes<4> (&y)[2], Pair& sum) {
  const Lanes<4> half_x[1] = {x[0] + x[1]}, half_y[1] = {y[0] + y[1]};
  Fold(half_x, half_y, sum);
}
ARAP_WIDE_BODY void Fold(const Lanes<8> (&x)[1], const Lanes<8> (&y)[1], Pair& sum) {
  const Lanes<4> half_x[1] = {__builtin_shufflevector(x[0], x[0], 0, 1, 2, 3) +
                              __builtin_shufflevector(x[0], x[0], 4, 5, 6, 7)};
  const Lanes<4> half_y[1] = {__builtin_shufflevector(y[0], y[0], 0, 1, 2, 3) +
                              __builtin_shufflevector(y[0], y[0], 4, 5, 6, 7)};
  Fold(half_x, half_y, sum);
}

// x := M x for the inverse M of the diagonal block, then rows −= L x. kMost is how many numbers a register holds. The
// panel that is read after this one lies before it in memory, which processors do not foresee. So with each row some
// numbers of a later panel are prefetched, from `next` on.
template <std::size_t kMost, std::size_t kPairs, std::size_t kWidth>
ARAP_WIDE_BODY void Forward(const double* m, const std::uint32_t* rows, std::size_t count,
                            std::size_t first, const double* next, double* x) {
  constexpr std::size_t kFilled = Filled(kWidth), kLanes = kMost < kFilled ? kMost : kFilled,
                        kParts = kFilled / kLanes;
  Lanes<kLanes> out_x[kPairs][kParts], out_y[kPairs][kParts];
#pragma GCC unroll 2
  for (std::size_t p = 0; p < kPairs; ++p) {
    Pair in[kWidth], out[kFilled]{};
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kWidth; ++c) in[c] = At<2>(x, (first + c) * kPairs + p);
    const double* entry = m;
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kWidth; ++c) {
      Pair sum = *entry++ * in[0];
#pragma GCC unroll 8
      for (std::size_t k = 1; k <= c; ++k) sum += *entry++ * in[k];
      out[c] = sum;
      At<2>(x, (first + c) * kPairs + p) = sum;
    }
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kParts; ++i) {
      Unzip(out + i * kLanes, out_x[p][i], out_y[p][i]);
    }
  }
  m += Diagonal(kWidth);
  for (std::size_t r = 0; r < count; ++r, m += kFilled) {
    __builtin_prefetch(next + kPanelWidth * r);
    Lanes<kLanes> l[kParts];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kParts; ++i) l[i] = NumbersFrom<kLanes>(m + i * kLanes);
    Pair* row = &At<2>(x, rows[r] * kPairs);
#pragma GCC unroll 2
    for (std::size_t p = 0; p < kPairs; ++p) {
      Lanes<kLanes> sum_x[kParts], sum_y[kParts];
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kParts; ++i) {
        sum_x[i] = l[i] * out_x[p][i];
        sum_y[i] = l[i] * out_y[p][i];
      }
      Pair sum;
      Fold(sum_x, sum_y, sum);
      row[p] -= sum;
    }
  }
}

// x := Mᵀ (x − Lᵀ rows)
template <std::size_t kMost, std::size_t kPairs, std::size_t kWidth>
ARAP_WIDE_BODY void Backward(const double* m, const std::uint32_t* rows, std::size_t count,
                             std::size_t first, double* x) {
  constexpr std::size_t kFilled = Filled(kWidth), kLanes = kMost < kFilled ? kMost : kFilled,
                        kParts = kFilled / kLanes;
  for (std::size_t p = 0; p < kPairs; ++p) {
    // Even and odd rows have sums of their own, so that an addition waits only for the last but one.
    Lanes<kLanes> sum_x[2][kParts], sum_y[2][kParts];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kParts; ++i) {
      sum_x[0][i] = sum_y[0][i] = sum_x[1][i] = sum_y[1][i] = Lanes<kLanes>{};
    }
    const double* l = m + Diagonal(kWidth);
    const double* points = x + 2 * p;
    std::size_t r = 0;
    for (; r + 1 < count; r += 2) {
#pragma GCC unroll 2
      for (std::size_t k = 0; k < 2; ++k, l += kFilled) {
        const double* row = points + 2 * kPairs * rows[r + k];
#pragma GCC unroll 4
        for (std::size_t i = 0; i < kParts; ++i) {
          const Lanes<kLanes> part = NumbersFrom<kLanes>(l + i * kLanes);
          sum_x[k][i] += part * row[0];
          sum_y[k][i] += part * row[1];
        }
      }
    }
    if (r < count) {
      const double* row = points + 2 * kPairs * rows[r];
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kParts; ++i) {
        const Lanes<kLanes> part = NumbersFrom<kLanes>(l + i * kLanes);
        sum_x[0][i] += part * row[0];
        sum_y[0][i] += part * row[1];
      }
    }
    double below_x[kFilled], below_y[kFilled];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kParts; ++i) {
      *reinterpret_cast<Lanes<kLanes>*>(below_x + i * kLanes) = sum_x[0][i] + sum_x[1][i];
      *reinterpret_cast<Lanes<kLanes>*>(below_y + i * kLanes) = sum_y[0][i] + sum_y[1][i];
    }
    Pair in[kWidth];
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kWidth; ++c) {
      in[c] = At<2>(x, (first + c) * kPairs + p) - Pair{below_x[c], below_y[c]};
    }
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kWidth; ++c) {
      Pair own{};
#pragma GCC unroll 8
      for (std::size_t k = c; k < kWidth; ++k) {
        own += m[k * (k + 1) / 2 + c] * in[k];
      }
      At<2>(x, (first + c) * kPairs + p) = own;
    }
  }
}

// One panel forwards, or backwards where there is no `next`.
template <std::size_t kMost, std::size_t kPairs, std::size_t kWidth>
ARAP_WIDE_BODY void OneWidth(const PackedPanels& factor, const Panel& panel, const double* next,
                             double* x) {
  const double* m = factor.values.get() + panel.values;
  const std::uint32_t* rows = factor.rows.data() + panel.rows;
  if (next) {
    Forward<kMost, kPairs, kWidth>(m, rows, panel.count, panel.first, next, x);
  } else {
    Backward<kMost, kPairs, kWidth>(m, rows, panel.count, panel.first, x);
  }
}

template <std::size_t kMost, std::size_t kPairs>
ARAP_WIDE_BODY void OnePanel(const PackedPanels& factor, const Panel& panel, const double* next,
                             double* x) {
  switch (panel.width) {
    case 1:
      return OneWidth<kMost, kPairs, 1>(factor, panel, next, x);
    case 2:
      return OneWidth<kMost, kPairs, 2>(factor, panel, next, x);
    case 3:
      return OneWidth<kMost, kPairs, 3>(factor, panel, next, x);
    case 4:
      return OneWidth<kMost, kPairs, 4>(factor, panel, next, x);
    case 5:
      return OneWidth<kMost, kPairs, 5>(factor, panel, next, x);
    case 6:
      return OneWidth<kMost, kPairs, 6>(factor, panel, next, x);
    case 7:
      return OneWidth<kMost, kPairs, 7>(factor, panel, next, x);
    default:
      return OneWidth<kMost, kPairs, 8>(factor, panel, next, x);
  }
}

// How many panels ahead numbers are prefetched.
constexpr std::size_t kAhead = 4;

// Where a panel's own numbers are all 0 it changes nothing below: a right-hand side with few other
// numbers walks the elimination tree from those to the root.
template <std::size_t kMost, std::size_t kPairs>
ARAP_WIDE_BODY void SolveReal(const PackedPanels& factor, PanelRange range, bool forward,
                              double* x) {
  for (std::size_t k = range.begin; forward && k < range.end; ++k) {
    const Panel& panel = factor.panels[k];
    if (IsZero(x + panel.first * 2 * kPairs, panel.width * 2 * kPairs)) continue;
    const Panel& next = factor.panels[k + kAhead < range.end ? k + kAhead : range.end - 1];
    OnePanel<kMost, kPairs>(factor, panel, factor.values.get() + next.values, x);
  }
  for (std::size_t k = range.end; !forward && k-- > range.begin;) {
    OnePanel<kMost, kPairs>(factor, factor.panels[k], nullptr, x);
  }
}

// Complex factors: a lane is a real or an imaginary part of a right-hand side.

// i·x, a complex number per pair of lanes.
ARAP_WIDE_BODY void TimesI(const Lanes<2>& x, Lanes<2>& ix) {
  ix = __builtin_shufflevector(x, -x, 3, 0);
}
ARAP_WIDE_BODY void TimesI(const Lanes<4>& x, Lanes<4>& ix) {
  ix = __builtin_shufflevector(x, -x, 5, 0, 7, 2);
}

// x := M x for the inverse M of the diagonal block, then rows −= L x.
template <std::size_t kLanes, std::size_t kColumns>
ARAP_WIDE_BODY void ForwardComplex(const double* m, const std::uint32_t* rows, std::size_t count,
                                   std::size_t first, double* x) {
  constexpr std::size_t kWidth = 2 * kColumns;
  Lanes<kLanes> in[kWidth]{}, out[kWidth]{};
  for (std::size_t c = 0; c < kColumns; ++c) {
    in[2 * c] = At<kLanes>(x, first + c);
    TimesI(in[2 * c], in[2 * c + 1]);
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    Lanes<kLanes> sum = *m++ * in[0];
#pragma GCC unroll 8
    for (std::size_t k = 1; k < 2 * (c + 1); ++k) sum += *m++ * in[k];
    out[2 * c] = sum;
    TimesI(sum, out[2 * c + 1]);
    At<kLanes>(x, first + c) = sum;
  }
  for (std::size_t r = 0; r < count; ++r, m += kWidth) {
    Lanes<kLanes> even = m[0] * out[0], odd = m[1] * out[1];
#pragma GCC unroll 8
    for (std::size_t k = 2; k < kWidth; k += 2) {
      even += m[k] * out[k];
      odd += m[k + 1] * out[k + 1];
    }
    even += odd;
    At<kLanes>(x, rows[r]) -= even;
  }
}

// x := Mᴴ (x − Lᴴ rows)
template <std::size_t kLanes, std::size_t kColumns>
ARAP_WIDE_BODY void BackwardComplex(const double* m, const std::uint32_t* rows, std::size_t count,
                                    std::size_t first, double* x) {
  constexpr std::size_t kWidth = 2 * kColumns, kDiagonal = kColumns * (kColumns + 1);
  Lanes<kLanes> sum[kWidth];
#pragma GCC unroll 8
  for (std::size_t k = 0; k < kWidth; ++k) sum[k] = Lanes<kLanes>{};
  const double* l = m + kDiagonal;
  for (std::size_t r = 0; r < count; ++r, l += kWidth) {
    const Lanes<kLanes> row = At<kLanes>(x, rows[r]);
#pragma GCC unroll 8
    for (std::size_t k = 0; k < kWidth; ++k) sum[k] += l[k] * row;
  }
  // From here on sum is x − Lᴴ rows, and i times it.
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    Lanes<kLanes> own = At<kLanes>(x, first + c) - sum[2 * c], turned;
    TimesI(sum[2 * c + 1], turned);
    own += turned;
    TimesI(own, sum[2 * c + 1]);
    sum[2 * c] = own;
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    Lanes<kLanes> own{};
#pragma GCC unroll 8
    for (std::size_t k = c; k < kColumns; ++k) {
      const double* entry = m + 2 * (k * (k + 1) / 2 + c);
      own += entry[0] * sum[2 * k];
      own -= entry[1] * sum[2 * k + 1];
    }
    At<kLanes>(x, first + c) = own;
  }
}

template <std::size_t kLanes, std::size_t kColumns>
ARAP_WIDE_BODY void OneComplexPanel(bool forward, const PackedPanels& factor, const Panel& panel,
                                    double* x) {
  const double* m = factor.values.get() + panel.values;
  const std::uint32_t* rows = factor.rows.data() + panel.rows;
  if (forward) {
    ForwardComplex<kLanes, kColumns>(m, rows, panel.count, panel.first, x);
  } else {
    BackwardComplex<kLanes, kColumns>(m, rows, panel.count, panel.first, x);
  }
}

template <std::size_t kLanes>
ARAP_WIDE_BODY void OneComplexPanel(bool forward, const PackedPanels& factor, const Panel& panel,
                                    double* x) {
  switch (panel.width) {
    case 1:
      return OneComplexPanel<kLanes, 1>(forward, factor, panel, x);
    case 2:
      return OneComplexPanel<kLanes, 2>(forward, factor, panel, x);
    case 3:
      return OneComplexPanel<kLanes, 3>(forward, factor, panel, x);
    default:
      return OneComplexPanel<kLanes, 4>(forward, factor, panel, x);
  }
}

template <std::size_t kLanes>
ARAP_WIDE_BODY void SolveComplex(const PackedPanels& factor, PanelRange range, bool forward,
                                 double* x) {
  for (std::size_t k = range.begin; forward && k < range.end; ++k) {
    const Panel& panel = factor.panels[k];
    if (IsZero(x + panel.first * kLanes, panel.width * kLanes)) continue;
    OneComplexPanel<kLanes>(true, factor, panel, x);
  }
  for (std::size_t k = range.end; !forward && k-- > range.begin;) {
    OneComplexPanel<kLanes>(false, factor, factor.panels[k], x);
  }
}

#define ARAP_SOLVE_TWINS(name, plain, wide, widest)                                    \
  void name(const PackedPanels& factor, PanelRange range, bool forward, double* x) {   \
    plain(factor, range, forward, x);                                                  \
  }                                                                                    \
  ARAP_WIDE(wide, name##Wide,                                                          \
            (const PackedPanels& factor, PanelRange range, bool forward, double* x),   \
            (factor, range, forward, x))                                               \
  ARAP_WIDEST(widest, name##Widest,                                                    \
              (const PackedPanels& factor, PanelRange range, bool forward, double* x), \
              (factor, range, forward, x))
ARAP_SOLVE_TWINS(Real2, (SolveReal<2, 1>), (SolveReal<4, 1>), (SolveReal<8, 1>))
ARAP_SOLVE_TWINS(Real4, (SolveReal<2, 2>), (SolveReal<4, 2>), (SolveReal<8, 2>))
ARAP_SOLVE_TWINS(Complex1, SolveComplex<2>, SolveComplex<2>, SolveComplex<2>)
ARAP_SOLVE_TWINS(Complex2, SolveComplex<4>, SolveComplex<4>, SolveComplex<4>)
#undef ARAP_SOLVE_TWINS

}  // namespace

std::span<const PackedKernels> SolveKernelsHere() {
  static constexpr PackedKernels kAll[] = {
      {Real2, Real4, Complex1, Complex2},
      {Real2Wide, Real4Wide, Complex1Wide, Complex2Wide},
      {Real2Widest, Real4Widest, Complex1Widest, Complex2Widest}};
  static const std::size_t kHave = HasWide() ? HasWidest() ? 3 : 2 : 1;
  return std::span(kAll).first(kHave);
}

const PackedKernels& SolveKernels() { return SolveKernelsHere().back(); }

}  // namespace arap
