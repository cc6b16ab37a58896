#include "core/sparse/packed_factor.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/base/large_pages.h"
#include "core/base/wide.h"

namespace arap {
namespace {

// kLanes numbers that are added and multiplied together. They lie anywhere a double may.
template <std::size_t kLanes>
struct LanesOf {
  typedef double Type __attribute__((vector_size(kLanes * sizeof(double)), aligned(8), may_alias));
};
template <std::size_t kLanes>
using Lanes = typename LanesOf<kLanes>::Type;

// One row of x.
template <std::size_t kLanes>
ARAP_WIDE_BODY Lanes<kLanes>& At(double* x, std::size_t row) {
  return *reinterpret_cast<Lanes<kLanes>*>(x + row * kLanes);
}

// i·x, a complex number per pair of lanes.
ARAP_WIDE_BODY void TimesI(const Lanes<2>& x, Lanes<2>& ix) {
  ix = __builtin_shufflevector(x, -x, 3, 0);
}
ARAP_WIDE_BODY void TimesI(const Lanes<4>& x, Lanes<4>& ix) {
  ix = __builtin_shufflevector(x, -x, 5, 0, 7, 2);
}

// Whether all of `count` numbers are 0.
ARAP_WIDE_BODY bool IsZero(const double* x, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    if (x[k] != 0) return false;
  }
  return true;
}

// x := M x for the inverse M of the diagonal block, then rows −= L x.
template <bool kComplex, std::size_t kLanes, std::size_t kWidth>
ARAP_WIDE_BODY void Forward(const double* m, const std::uint32_t* rows, std::size_t count,
                            std::size_t first, double* x) {
  constexpr std::size_t kStep = kComplex ? 2 : 1, kColumns = kWidth / kStep;
  Lanes<kLanes> in[kWidth]{}, out[kWidth]{};
  for (std::size_t c = 0; c < kColumns; ++c) {
    in[kStep * c] = At<kLanes>(x, first + c);
    if constexpr (kComplex) TimesI(in[2 * c], in[2 * c + 1]);
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    Lanes<kLanes> sum = *m++ * in[0];
#pragma GCC unroll 8
    for (std::size_t k = 1; k < kStep * (c + 1); ++k) sum += *m++ * in[k];
    out[kStep * c] = sum;
    if constexpr (kComplex) TimesI(sum, out[2 * c + 1]);
    At<kLanes>(x, first + c) = sum;
  }
  for (std::size_t r = 0; r < count; ++r, m += kWidth) {
    Lanes<kLanes>& row = At<kLanes>(x, rows[r]);
    Lanes<kLanes> even = m[0] * out[0];
    if constexpr (kWidth > 1) {
      Lanes<kLanes> odd = m[1] * out[1];
#pragma GCC unroll 8
      for (std::size_t k = 2; k < kWidth; k += 2) {
        even += m[k] * out[k];
        if (k + 1 < kWidth) odd += m[k + 1] * out[k + 1];
      }
      even += odd;
    }
    row -= even;
  }
}

// x := Mᴴ (x − Lᴴ rows)
template <bool kComplex, std::size_t kLanes, std::size_t kWidth>
ARAP_WIDE_BODY void Backward(const double* m, const std::uint32_t* rows, std::size_t count,
                             std::size_t first, double* x) {
  constexpr std::size_t kStep = kComplex ? 2 : 1, kColumns = kWidth / kStep;
  constexpr std::size_t kDiagonal = kColumns * (kColumns + 1) / 2 * kStep;
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
    Lanes<kLanes> own = At<kLanes>(x, first + c) - sum[kStep * c];
    if constexpr (kComplex) {
      Lanes<kLanes> turned;
      TimesI(sum[2 * c + 1], turned);
      own += turned;
      TimesI(own, sum[2 * c + 1]);
    }
    sum[kStep * c] = own;
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
    Lanes<kLanes> own{};
#pragma GCC unroll 8
    for (std::size_t k = c; k < kColumns; ++k) {
      const double* entry = m + kStep * (k * (k + 1) / 2 + c);
      own += entry[0] * sum[kStep * k];
      if constexpr (kComplex) own -= entry[1] * sum[2 * k + 1];
    }
    At<kLanes>(x, first + c) = own;
  }
}

template <bool kComplex, std::size_t kLanes, std::size_t kWidth>
ARAP_WIDE_BODY void OnePanel(bool forward, const double* m, const std::uint32_t* rows,
                             std::size_t count, std::size_t first, double* x) {
  if (forward) {
    Forward<kComplex, kLanes, kWidth>(m, rows, count, first, x);
  } else {
    Backward<kComplex, kLanes, kWidth>(m, rows, count, first, x);
  }
}

template <bool kComplex, std::size_t kLanes>
ARAP_WIDE_BODY void OnePanel(bool forward, const PackedPanels& factor, const Panel& panel,
                             double* x) {
  const double* m = factor.values.get() + panel.values;
  const std::uint32_t* rows = factor.rows.data() + panel.rows;
  const std::size_t count = panel.count, first = panel.first;
  if constexpr (kComplex) {
    switch (panel.width) {
      case 1:
        return OnePanel<true, kLanes, 2>(forward, m, rows, count, first, x);
      case 2:
        return OnePanel<true, kLanes, 4>(forward, m, rows, count, first, x);
      case 3:
        return OnePanel<true, kLanes, 6>(forward, m, rows, count, first, x);
      default:
        return OnePanel<true, kLanes, 8>(forward, m, rows, count, first, x);
    }
  } else {
    switch (panel.width) {
      case 1:
        return OnePanel<false, kLanes, 1>(forward, m, rows, count, first, x);
      case 2:
        return OnePanel<false, kLanes, 2>(forward, m, rows, count, first, x);
      case 3:
        return OnePanel<false, kLanes, 3>(forward, m, rows, count, first, x);
      case 4:
        return OnePanel<false, kLanes, 4>(forward, m, rows, count, first, x);
      case 5:
        return OnePanel<false, kLanes, 5>(forward, m, rows, count, first, x);
      case 6:
        return OnePanel<false, kLanes, 6>(forward, m, rows, count, first, x);
      case 7:
        return OnePanel<false, kLanes, 7>(forward, m, rows, count, first, x);
      default:
        return OnePanel<false, kLanes, 8>(forward, m, rows, count, first, x);
    }
  }
}

// Where a panel's own numbers are all 0 it changes nothing below: a right-hand side with few other
// numbers walks the elimination tree from those to the root.
template <bool kComplex, std::size_t kLanes>
ARAP_WIDE_BODY void SolveInPlace(const PackedPanels& factor, double* x) {
  for (const Panel& panel : factor.panels) {
    if (IsZero(x + panel.first * kLanes, panel.width * kLanes)) continue;
    OnePanel<kComplex, kLanes>(true, factor, panel, x);
  }
  for (std::size_t k = factor.panels.size(); k-- > 0;) {
    OnePanel<kComplex, kLanes>(false, factor, factor.panels[k], x);
  }
}

ARAP_WIDE_BODY void Real2(const PackedPanels& factor, double* x) {
  SolveInPlace<false, 2>(factor, x);
}
ARAP_WIDE_BODY void Real4(const PackedPanels& factor, double* x) {
  SolveInPlace<false, 4>(factor, x);
}
ARAP_WIDE_BODY void Complex1(const PackedPanels& factor, double* x) {
  SolveInPlace<true, 2>(factor, x);
}
ARAP_WIDE_BODY void Complex2(const PackedPanels& factor, double* x) {
  SolveInPlace<true, 4>(factor, x);
}
ARAP_WIDE(Real2, Real2Wide, (const PackedPanels& factor, double* x), (factor, x))
ARAP_WIDE(Real4, Real4Wide, (const PackedPanels& factor, double* x), (factor, x))
ARAP_WIDE(Complex1, Complex1Wide, (const PackedPanels& factor, double* x), (factor, x))
ARAP_WIDE(Complex2, Complex2Wide, (const PackedPanels& factor, double* x), (factor, x))

template <class Scalar>
constexpr std::size_t kNumbers = sizeof(Scalar) / sizeof(double);

double* Put(double* out, double x) {
  *out = x;
  return out + 1;
}
double* Put(double* out, std::complex<double> x) {
  out[0] = x.real();
  out[1] = x.imag();
  return out + 2;
}

// Writes the inverse of the lower triangle of a dense block, row by row.
template <class Scalar>
double* PutInverse(const Scalar* block, std::size_t stride, std::size_t width, double* out) {
  Scalar inverse[kPanelWidth][kPanelWidth];
  for (std::size_t i = 0; i < width; ++i) {
    const Scalar pivot = Scalar(1) / block[i * stride + i];
    for (std::size_t j = 0; j < i; ++j) {
      Scalar sum(0);
      for (std::size_t k = j; k < i; ++k) sum += block[k * stride + i] * inverse[k][j];
      inverse[i][j] = -sum * pivot;
      out = Put(out, inverse[i][j]);
    }
    inverse[i][i] = pivot;
    out = Put(out, pivot);
  }
  return out;
}

}  // namespace

const PackedKernels& PlainSolveKernels() {
  static constexpr PackedKernels kPlain{Real2, Real4, Complex1, Complex2};
  return kPlain;
}

const PackedKernels& SolveKernels() {
  static constexpr PackedKernels kWide{Real2Wide, Real4Wide, Complex1Wide, Complex2Wide};
  return HasWide() ? kWide : PlainSolveKernels();
}

template <class Scalar>
PackedFactor<Scalar>::PackedFactor(const Supernodes<Scalar>& l, const ReadFrom& read_from)
    : order_(l.order.begin(), l.order.end()) {
  std::size_t panels = 0;
  constexpr std::size_t kColumns = kPanelWidth / kNumbers<Scalar>;
  for (std::size_t s = 0; s + 1 < l.first.size(); ++s) {
    const auto width = static_cast<std::size_t>(l.first[s + 1] - l.first[s]);
    const auto height = static_cast<std::size_t>(l.rows_begin[s + 1] - l.rows_begin[s]);
    panels += (width + kColumns - 1) / kColumns;
    for (std::size_t c = 0; c < width; ++c) panels_.numbers += (height - c) * kNumbers<Scalar>;
  }
  panels_.panels.reserve(panels);
  panels_.rows.assign(l.rows.begin(), l.rows.end());
  // Not set to 0: memory that is not written yet is not there yet.
  panels_.values = std::make_unique_for_overwrite<double[]>(panels_.numbers);
  PreferLargePages(panels_.values.get(), panels_.numbers * sizeof(double));
  double* out = panels_.values.get();
  // The last first: the pass from the root to the leaves is the one that is never cut short, and
  // reads forwards so.
  for (std::size_t s = l.first.size() - 1; s-- > 0;) {
    out = Pack(l, s, out);
    if (read_from) read_from(l.values + l.values_begin[s]);
  }
  std::reverse(panels_.panels.begin(), panels_.panels.end());
}

template <class Scalar>
double* PackedFactor<Scalar>::Pack(const Supernodes<Scalar>& l, std::size_t supernode,
                                   double* out) {
  const auto first = static_cast<std::size_t>(l.first[supernode]);
  const auto width = static_cast<std::size_t>(l.first[supernode + 1]) - first;
  const auto rows = static_cast<std::size_t>(l.rows_begin[supernode]);
  const auto height = static_cast<std::size_t>(l.rows_begin[supernode + 1]) - rows;
  const Scalar* block = l.values + l.values_begin[supernode];
  // Panels of equal width.
  constexpr std::size_t kColumns = kPanelWidth / kNumbers<Scalar>;
  const std::size_t panels = (width + kColumns - 1) / kColumns;
  for (std::size_t p = panels; p-- > 0;) {
    const std::size_t begin = p * width / panels, end = (p + 1) * width / panels;
    Panel panel;
    panel.first = static_cast<std::uint32_t>(first + begin);
    panel.width = static_cast<std::uint32_t>(end - begin);
    panel.rows = static_cast<std::uint32_t>(rows + end);
    panel.count = static_cast<std::uint32_t>(height - end);
    panel.values = static_cast<std::size_t>(out - panels_.values.get());
    panels_.panels.push_back(panel);
    out = PutInverse(block + begin * height + begin, height, end - begin, out);
    for (std::size_t r = end; r < height; ++r) {
      for (std::size_t c = begin; c < end; ++c) out = Put(out, block[c * height + r]);
    }
  }
  return out;
}

template <class Scalar>
void PackedFactor<Scalar>::Solve(const Scalar* right, std::size_t columns, Scalar* solution,
                                 std::span<double> scratch, const PackedKernels& kernels) const {
  const std::size_t n = size();
  constexpr bool kComplex = kNumbers<Scalar> == 2;
  void* memory = scratch.data();
  std::size_t space = scratch.size_bytes();
  auto* x = static_cast<double*>(
      std::align(kAlign * sizeof(double), 4 * n * sizeof(double), memory, space));
  auto* rows = reinterpret_cast<Scalar*>(x);
  for (std::size_t begin = 0; begin < columns;) {
    // Columns that are taken together, and those that they are padded to.
    const std::size_t left = columns - begin;
    const std::size_t take = std::min<std::size_t>(left, kComplex ? 2 : 4);
    const std::size_t lanes = kComplex ? take : take > 2 ? 4 : 2;
    // −0 becomes 0, or a number's sign could depend on its neighbours.
    for (std::size_t c = 0; c < lanes; ++c) {
      const Scalar* column = c < take ? right + (begin + c) * n : nullptr;
      for (std::size_t k = 0; k < n; ++k) {
        rows[k * lanes + c] =
            column ? column[static_cast<std::size_t>(order_[k])] + Scalar(0) : Scalar(0);
      }
    }
    if constexpr (kComplex) {
      (lanes == 1 ? kernels.complex1 : kernels.complex2)(panels_, x);
    } else {
      (lanes == 2 ? kernels.real2 : kernels.real4)(panels_, x);
    }
    for (std::size_t c = 0; c < take; ++c) {
      Scalar* column = solution + (begin + c) * n;
      for (std::size_t k = 0; k < n; ++k) {
        column[static_cast<std::size_t>(order_[k])] = rows[k * lanes + c];
      }
    }
    begin += take;
  }
}

template <class Scalar>
std::size_t PackedFactor<Scalar>::bytes() const {
  return order_.size() * sizeof(int) + panels_.panels.size() * sizeof(Panel) +
         panels_.rows.size() * sizeof(std::uint32_t) + panels_.numbers * sizeof(double);
}

template class PackedFactor<double>;
template class PackedFactor<std::complex<double>>;

}  // namespace arap
