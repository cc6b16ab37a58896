#include "core/sparse/supernodal.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/base/lanes.h"

namespace arap {
namespace {

template <class Scalar>
constexpr std::size_t kNumbers = sizeof(Scalar) / sizeof(double);

#define ARAP_INLINE [[gnu::always_inline]] inline

// Numbers of one matrix, `stride` apart from column to column.
struct View {
  const double* numbers;
  std::size_t stride;
};

// out := X Yᵀ for kVectors·kLanes rows of X and kColumns rows of Y; both have `depth` columns.
template <std::size_t kLanes, std::size_t kVectors, std::size_t kColumns>
ARAP_INLINE void Tile(const double* x, const double* y, std::size_t stride, std::size_t depth,
                      double* out, std::size_t out_stride) {
  Lanes<kLanes> sum[kColumns][kVectors];
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) sum[c][v] = Lanes<kLanes>{};
  }
  for (std::size_t k = 0; k < depth; ++k, x += stride, y += stride) {
    Lanes<kLanes> left[kVectors];
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v)
      left[v] = *reinterpret_cast<const Lanes<kLanes>*>(x + v * kLanes);
#pragma GCC unroll 8
    for (std::size_t c = 0; c < kColumns; ++c) {
#pragma GCC unroll 8
      for (std::size_t v = 0; v < kVectors; ++v) sum[c][v] += left[v] * y[c];
    }
  }
#pragma GCC unroll 8
  for (std::size_t c = 0; c < kColumns; ++c) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
      *reinterpret_cast<Lanes<kLanes>*>(out + c * out_stride + v * kLanes) = sum[c][v];
    }
  }
}

template <std::size_t kLanes, std::size_t kVectors, std::size_t kColumns>
ARAP_INLINE void Strip(const double* x, const double* y, std::size_t stride, std::size_t depth,
                       std::size_t rows, double* out, std::size_t out_stride) {
  std::size_t r = 0;
  for (; r + kLanes * kVectors <= rows; r += kLanes * kVectors) {
    Tile<kLanes, kVectors, kColumns>(x + r, y, stride, depth, out + r, out_stride);
  }
  if constexpr (kVectors > 1) {
    for (; r + kLanes <= rows; r += kLanes)
      Tile<kLanes, 1, kColumns>(x + r, y, stride, depth, out + r, out_stride);
  }
  if constexpr (kLanes > 4) {
    if (r + 4 <= rows) Tile<4, 1, kColumns>(x + r, y, stride, depth, out + r, out_stride), r += 4;
  }
  if (r + 2 <= rows) Tile<2, 1, kColumns>(x + r, y, stride, depth, out + r, out_stride), r += 2;
  if (r < rows) {
    double sum[kColumns]{};
    for (std::size_t k = 0; k < depth; ++k) {
      for (std::size_t c = 0; c < kColumns; ++c) sum[c] += x[r + k * stride] * y[c + k * stride];
    }
    for (std::size_t c = 0; c < kColumns; ++c) out[r + c * out_stride] = sum[c];
  }
}

// out (rows×columns) := X Xᵀ of the first rows of X, as far as it is on or below the diagonal; some above it too.
template <std::size_t kLanes, std::size_t kVectors>
ARAP_INLINE void SquareOf(View x, std::size_t rows, std::size_t columns, std::size_t depth,
                          double* out, std::size_t out_stride) {
  std::size_t c = 0;
  const auto strip = [&]<std::size_t kColumns>() __attribute__((always_inline)) {
    Strip<kLanes, kVectors, kColumns>(x.numbers + c, x.numbers + c, x.stride, depth, rows - c,
                                      out + c * out_stride + c, out_stride);
  };
  for (; c + 4 <= columns; c += 4) strip.template operator()<4>();
  switch (columns - c) {
    case 3:
      return strip.template operator()<3>();
    case 2:
      return strip.template operator()<2>();
    case 1:
      return strip.template operator()<1>();
    default:
      return;
  }
}

using Square = void (*)(View x, std::size_t rows, std::size_t columns, std::size_t depth,
                        double* out, std::size_t out_stride);

void SquarePlain(View x, std::size_t rows, std::size_t columns, std::size_t depth, double* out,
                 std::size_t out_stride) {
  SquareOf<2, 2>(x, rows, columns, depth, out, out_stride);
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] void SquareWide(View x, std::size_t rows, std::size_t columns,
                                        std::size_t depth, double* out, std::size_t out_stride) {
  SquareOf<4, 2>(x, rows, columns, depth, out, out_stride);
}
[[gnu::target("avx512f")]] void SquareWidest(View x, std::size_t rows, std::size_t columns,
                                             std::size_t depth, double* out,
                                             std::size_t out_stride) {
  SquareOf<8, 2>(x, rows, columns, depth, out, out_stride);
}
#endif

Square SquareBy(ProductCode code) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (code == ProductCode::kAvx512) return SquareWidest;
  if (code == ProductCode::kAvx2) return SquareWide;
#endif
  return SquarePlain;
}

// Real columns of one product.
constexpr std::size_t kStrip = 64;
// Columns that are factored one by one.
constexpr std::size_t kOneByOne = 4;

int Int(std::size_t n) { return static_cast<int>(n); }

Pair& Place(std::complex<double>* x) { return *reinterpret_cast<Pair*>(x); }
Pair Place(const std::complex<double>* x) { return *reinterpret_cast<const Pair*>(x); }

// column −= other·conj(f), for `count` rows.
void SubtractTimes(const double* other, double f, std::size_t count, double* column) {
  for (std::size_t r = 0; r < count; ++r) column[r] -= other[r] * f;
}
void SubtractTimes(const std::complex<double>* other, std::complex<double> f, std::size_t count,
                   std::complex<double>* column) {
  const Pair same{f.real(), f.real()}, turned{f.imag(), -f.imag()};
  for (std::size_t r = 0; r < count; ++r) {
    const Pair x = Place(other + r);
    Place(column + r) -= x * same + __builtin_shufflevector(x, x, 1, 0) * turned;
  }
}

// What one column of a product takes from row i, of `rows`: of a real factor column j itself.
Pair Taken(const double* product, std::size_t rows, std::size_t i) {
  // Both numbers of the row against both of the other: conj(y) x.
  const Pair p = *reinterpret_cast<const Pair*>(product + 2 * i);
  const Pair q = *reinterpret_cast<const Pair*>(product + 2 * rows + 2 * i);
  constexpr Pair kTurn{1, -1};
  return p + __builtin_shufflevector(q, q, 1, 0) * kTurn;
}

template <class Scalar>
class Factorisation {
 public:
  Factorisation(const SupernodalPattern& pattern, const Eigen::SparseMatrix<Scalar>& lower,
                Scalar* values, ProductCode code)
      : pattern_(pattern), values_(values), square_(SquareBy(code)) {
    TakeMatrix(lower);
    FindSizes();
  }

  bool Run() {
    for (std::size_t s = 0; s < supernodes_; ++s) {
      Start(s);
      for (int d = first_pending_[s]; d >= 0;) {
        const auto from = static_cast<std::size_t>(d);
        d = next_[from];
        Subtract(from, s);
      }
      if (!Columns(BlockOf(s), HeightOf(s), 0, WidthOf(s))) return false;
      position_[s] = WidthOf(s);
      Enlist(s);
    }
    return true;
  }

 private:
  std::size_t FirstOf(std::size_t s) const { return static_cast<std::size_t>(pattern_.first[s]); }
  std::size_t WidthOf(std::size_t s) const { return FirstOf(s + 1) - FirstOf(s); }
  std::size_t RowsBeginOf(std::size_t s) const {
    return static_cast<std::size_t>(pattern_.rows_begin[s]);
  }
  std::size_t HeightOf(std::size_t s) const { return RowsBeginOf(s + 1) - RowsBeginOf(s); }
  const int* RowsOf(std::size_t s) const { return pattern_.rows.data() + RowsBeginOf(s); }
  Scalar* BlockOf(std::size_t s) const { return values_ + pattern_.values_begin[s]; }

  // The matrix by columns of the factor.
  void TakeMatrix(const Eigen::SparseMatrix<Scalar>& lower) {
    const auto n = static_cast<std::size_t>(lower.rows());
    std::vector<int> place(n);
    for (std::size_t k = 0; k < n; ++k) place[static_cast<std::size_t>(pattern_.order[k])] = Int(k);
    const int *outer = lower.outerIndexPtr(), *inner = lower.innerIndexPtr();
    const Scalar* numbers = lower.valuePtr();
    begin_.assign(n + 1, 0);
    for (std::size_t c = 0; c < n; ++c) {
      for (int at = outer[c]; at < outer[c + 1]; ++at)
        ++begin_[static_cast<std::size_t>(
                     std::min(place[c], place[static_cast<std::size_t>(inner[at])])) +
                 1];
    }
    for (std::size_t k = 0; k < n; ++k) begin_[k + 1] += begin_[k];
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    row_.resize(static_cast<std::size_t>(begin_[n]));
    number_.resize(row_.size());
    for (std::size_t c = 0; c < n; ++c) {
      for (int at = outer[c]; at < outer[c + 1]; ++at) {
        const int row = place[static_cast<std::size_t>(inner[at])], column = place[c];
        const auto to =
            static_cast<std::size_t>(next[static_cast<std::size_t>(std::min(row, column))]++);
        row_[to] = std::max(row, column);
        number_[to] = row >= column ? numbers[at] : Eigen::numext::conj(numbers[at]);
      }
    }
  }

  void FindSizes() {
    supernodes_ = pattern_.first.size() - 1;
    const std::size_t n = pattern_.order.size();
    std::size_t highest = 0;
    supernode_of_.resize(n);
    for (std::size_t s = 0; s < supernodes_; ++s) {
      highest = std::max(highest, HeightOf(s));
      for (std::size_t c = FirstOf(s); c < FirstOf(s + 1); ++c) supernode_of_[c] = Int(s);
    }
    row_in_.resize(n);
    relative_.resize(highest);
    product_.resize(kNumbers<Scalar> * highest * kStrip);
    first_pending_.assign(supernodes_, -1);
    next_.assign(supernodes_, -1);
    position_.assign(supernodes_, 0);
  }

  // The block of s is that of the matrix.
  void Start(std::size_t s) {
    const std::size_t height = HeightOf(s);
    const int* rows = RowsOf(s);
    for (std::size_t r = 0; r < height; ++r) row_in_[static_cast<std::size_t>(rows[r])] = Int(r);
    Scalar* column = BlockOf(s);
    std::fill(column, column + height * WidthOf(s), Scalar(0));
    for (std::size_t c = FirstOf(s); c < FirstOf(s + 1); ++c, column += height) {
      for (auto at = static_cast<std::size_t>(begin_[c]);
           at < static_cast<std::size_t>(begin_[c + 1]); ++at) {
        column[row_in_[static_cast<std::size_t>(row_[at])]] += number_[at];
      }
    }
  }

  // `s` is a matter of the supernode that its next row belongs to.
  void Enlist(std::size_t s) {
    if (position_[s] == HeightOf(s)) return;
    const auto to =
        static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(RowsOf(s)[position_[s]])]);
    next_[s] = first_pending_[to];
    first_pending_[to] = Int(s);
  }

  void Multiply(const Scalar* x, std::size_t height, std::size_t rows, std::size_t columns,
                std::size_t depth) {
    const View view{reinterpret_cast<const double*>(x), kNumbers<Scalar> * height};
    rows *= kNumbers<Scalar>, columns *= kNumbers<Scalar>;
    square_(view, rows, columns, depth, product_.data(), rows);
  }

  // column[at(i)] −= what Multiply made for row i and column j, from i = j on.
  template <class At>
  void SubtractProduct(std::size_t rows, std::size_t j, Scalar* column, At at) const {
    if constexpr (kNumbers<Scalar> == 1) {
      const double* p = product_.data() + j * rows;
      for (std::size_t i = j; i < rows; ++i) column[at(i)] -= p[i];
    } else {
      const double* p = product_.data() + 4 * j * rows;
      for (std::size_t i = j; i < rows; ++i) Place(column + at(i)) -= Taken(p, rows, i);
    }
  }

  // Takes from the block of s what the columns of d do there.
  void Subtract(std::size_t d, std::size_t s) {
    const std::size_t begin = position_[d], height = HeightOf(d);
    const int* rows = RowsOf(d);
    std::size_t end = begin;
    for (; end < height && rows[end] < pattern_.first[s + 1]; ++end) {
    }
    for (std::size_t r = begin; r < height; ++r) {
      relative_[r - begin] = static_cast<std::size_t>(row_in_[static_cast<std::size_t>(rows[r])]);
    }
    constexpr std::size_t kTogether = kStrip / kNumbers<Scalar>;
    for (std::size_t c = begin; c < end; c += kTogether) {
      const std::size_t count = std::min(kTogether, end - c);
      Multiply(BlockOf(d) + c, height, height - c, count, WidthOf(d));
      const std::size_t* relative = relative_.data() + (c - begin);
      for (std::size_t j = 0; j < count; ++j) {
        SubtractProduct(height - c, j, BlockOf(s) + relative[j] * HeightOf(s),
                        [relative](std::size_t i) { return relative[i]; });
      }
    }
    position_[d] = end;
    Enlist(d);
  }

  // Factors columns [from, to) of a block, which lack nothing but one another.
  bool Columns(Scalar* block, std::size_t height, std::size_t from, std::size_t to) {
    if (to - from <= kOneByOne) return OneByOne(block, height, from, to);
    const std::size_t middle = from + (to - from) / 2;
    if (!Columns(block, height, from, middle)) return false;
    constexpr std::size_t kTogether = kStrip / kNumbers<Scalar>;
    for (std::size_t c = middle; c < to; c += kTogether) {
      const std::size_t count = std::min(kTogether, to - c);
      Multiply(block + from * height + c, height, height - c, count, middle - from);
      for (std::size_t j = 0; j < count; ++j) {
        SubtractProduct(height - c, j, block + (c + j) * height + c,
                        [](std::size_t i) { return i; });
      }
    }
    return Columns(block, height, middle, to);
  }

  bool OneByOne(Scalar* block, std::size_t height, std::size_t from, std::size_t to) const {
    for (std::size_t c = from; c < to; ++c) {
      Scalar* column = block + c * height;
      for (std::size_t k = from; k < c; ++k) {
        const Scalar* other = block + k * height;
        SubtractTimes(other + c, other[c], height - c, column + c);
      }
      const double pivot = std::real(column[c]);
      if (!(pivot > 0)) return false;  // NaN too
      const double root = std::sqrt(pivot), part = 1 / root;
      column[c] = root;
      for (std::size_t r = c + 1; r < height; ++r) column[r] *= part;
    }
    return true;
  }

  const SupernodalPattern& pattern_;
  Scalar* values_;
  Square square_;
  std::size_t supernodes_ = 0;
  // The matrix: column c of the factor has rows row_[begin_[c]]….
  std::vector<int> begin_, row_;
  std::vector<Scalar> number_;
  std::vector<int> supernode_of_;  // #n, of a column
  std::vector<int> row_in_;        // #n, of a row in the block that is being made
  // Supernodes that have rows in one that is still to come, as lists; and how far their rows are done with.
  std::vector<int> first_pending_, next_;
  std::vector<std::size_t> position_;
  std::vector<std::size_t> relative_;
  std::vector<double> product_;
};

}  // namespace

ProductCode BestProductCode() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx512f")) return ProductCode::kAvx512;
  if (__builtin_cpu_supports("avx2")) return ProductCode::kAvx2;
#endif
  return ProductCode::kPlain;
}

template <class Scalar>
bool FactorSupernodes(const SupernodalPattern& pattern, const Eigen::SparseMatrix<Scalar>& lower,
                      Scalar* values, ProductCode code) {
  return Factorisation<Scalar>(pattern, lower, values, code).Run();
}

template bool FactorSupernodes(const SupernodalPattern&, const Eigen::SparseMatrix<double>&,
                               double*, ProductCode);
template bool FactorSupernodes(const SupernodalPattern&,
                               const Eigen::SparseMatrix<std::complex<double>>&,
                               std::complex<double>*, ProductCode);

}  // namespace arap
