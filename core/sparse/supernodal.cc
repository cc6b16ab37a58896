#include "core/sparse/supernodal.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/base/lanes.h"
#include "core/sparse/block_products.h"

namespace arap {
namespace {

template <class Scalar>
constexpr std::size_t kNumbers = sizeof(Scalar) / sizeof(double);

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

// conj(y) x, where x is the complex number of row i: `by_re` holds the products of all rows with the real part of y,
// `by_im` those with its imaginary part.
Pair Taken(const double* by_re, const double* by_im, std::size_t i) {
  const Pair p = *reinterpret_cast<const Pair*>(by_re + 2 * i),
             q = *reinterpret_cast<const Pair*>(by_im + 2 * i);
  constexpr Pair kTurn{1, -1};
  return p + __builtin_shufflevector(q, q, 1, 0) * kTurn;
}

template <class Scalar>
class Factorisation {
 public:
  Factorisation(const SupernodalPattern& pattern, const Eigen::SparseMatrix<Scalar>& lower,
                Scalar* values, ProductCode code)
      : pattern_(pattern),
        matrix_(lower.valuePtr()),
        values_(values),
        products_(code, kNumbers<Scalar> * Highest(pattern)) {
    FindEntries(lower);
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

  // Where the numbers of the factor's columns stand in the matrix.
  void FindEntries(const Eigen::SparseMatrix<Scalar>& lower) {
    const auto n = static_cast<std::size_t>(lower.rows());
    std::vector<int> place(n);
    for (std::size_t k = 0; k < n; ++k) place[static_cast<std::size_t>(pattern_.order[k])] = Int(k);
    const int *outer = lower.outerIndexPtr(), *inner = lower.innerIndexPtr();
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
    entry_.resize(row_.size());
    for (std::size_t c = 0; c < n; ++c) {
      for (int at = outer[c]; at < outer[c + 1]; ++at) {
        const int row = place[static_cast<std::size_t>(inner[at])], column = place[c];
        const auto to =
            static_cast<std::size_t>(next[static_cast<std::size_t>(std::min(row, column))]++);
        row_[to] = std::max(row, column);
        entry_[to] = row >= column ? at : ~at;
      }
    }
  }

  // The most rows of a block.
  static std::size_t Highest(const SupernodalPattern& pattern) {
    int highest = 0;
    for (std::size_t s = 0; s + 1 < pattern.rows_begin.size(); ++s) {
      highest = std::max(highest, pattern.rows_begin[s + 1] - pattern.rows_begin[s]);
    }
    return static_cast<std::size_t>(highest);
  }

  void FindSizes() {
    supernodes_ = pattern_.first.size() - 1;
    const std::size_t n = pattern_.order.size();
    supernode_of_.resize(n);
    for (std::size_t s = 0; s < supernodes_; ++s) {
      for (std::size_t c = FirstOf(s); c < FirstOf(s + 1); ++c) supernode_of_[c] = Int(s);
    }
    row_in_.resize(n);
    relative_.resize(Highest(pattern_));
    first_pending_.assign(supernodes_, -1);
    next_.assign(supernodes_, -1);
    position_.assign(supernodes_, 0);
  }

  Scalar NumberOf(int entry) const {
    return entry >= 0 ? matrix_[entry] : Eigen::numext::conj(matrix_[~entry]);
  }

  // Sets the block of s to the numbers of the matrix.
  void Start(std::size_t s) {
    const std::size_t height = HeightOf(s);
    const int* rows = RowsOf(s);
    for (std::size_t r = 0; r < height; ++r) row_in_[static_cast<std::size_t>(rows[r])] = Int(r);
    Scalar* column = BlockOf(s);
    std::fill(column, column + height * WidthOf(s), Scalar(0));
    for (std::size_t c = FirstOf(s); c < FirstOf(s + 1); ++c, column += height) {
      for (auto at = static_cast<std::size_t>(begin_[c]);
           at < static_cast<std::size_t>(begin_[c + 1]); ++at) {
        column[row_in_[static_cast<std::size_t>(row_[at])]] += NumberOf(entry_[at]);
      }
    }
  }

  // Puts s on the list of the supernode that its next row belongs to.
  void Enlist(std::size_t s) {
    if (position_[s] == HeightOf(s)) return;
    const auto to =
        static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(RowsOf(s)[position_[s]])]);
    next_[s] = first_pending_[to];
    first_pending_[to] = Int(s);
  }

  void Multiply(const Scalar* x, std::size_t height, std::size_t rows, std::size_t columns,
                std::size_t depth) {
    const BlockView view{reinterpret_cast<const double*>(x), kNumbers<Scalar> * height};
    products_.Square(view, kNumbers<Scalar> * rows, kNumbers<Scalar> * columns, depth);
  }

  // column[at(i)] −= what Multiply made for row i and column j, from i = j on.
  template <class At>
  void SubtractProduct(std::size_t rows, std::size_t j, Scalar* column, At at) const {
    if constexpr (kNumbers<Scalar> == 1) {
      const double* p = products_.column(j);
      for (std::size_t i = j; i < rows; ++i) column[at(i)] -= p[i];
    } else {
      const double *p = products_.column(2 * j), *q = products_.column(2 * j + 1);
      for (std::size_t i = j; i < rows; ++i) Place(column + at(i)) -= Taken(p, q, i);
    }
  }

  // Subtracts from the block of s what the columns of d contribute to it.
  void Subtract(std::size_t d, std::size_t s) {
    const std::size_t begin = position_[d], height = HeightOf(d);
    const int* rows = RowsOf(d);
    std::size_t end = begin;
    for (; end < height && rows[end] < pattern_.first[s + 1]; ++end) {
    }
    for (std::size_t r = begin; r < height; ++r) {
      relative_[r - begin] = static_cast<std::size_t>(row_in_[static_cast<std::size_t>(rows[r])]);
    }
    constexpr std::size_t kTogether = BlockProducts::kMostColumns / kNumbers<Scalar>;
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

  // Factors columns [from, to) of a block. The contributions of all columns before `from` have been subtracted.
  bool Columns(Scalar* block, std::size_t height, std::size_t from, std::size_t to) {
    if (to - from <= kOneByOne) return OneByOne(block, height, from, to);
    const std::size_t middle = from + (to - from) / 2;
    if (!Columns(block, height, from, middle)) return false;
    constexpr std::size_t kTogether = BlockProducts::kMostColumns / kNumbers<Scalar>;
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
  const Scalar* matrix_;
  Scalar* values_;
  BlockProducts products_;
  std::size_t supernodes_ = 0;
  // The entries of the matrix in column c of the factor are begin_[c]…begin_[c + 1]−1: entry k is in row row_[k] and has
  // the number matrix_[entry_[k]], or the conjugate of matrix_[~entry_[k]] where entry_[k] is negative.
  std::vector<int> begin_, row_, entry_;
  std::vector<int> supernode_of_;  // #n, of a column
  std::vector<int> row_in_;        // #n, of a row in the block that is being made
  // A list for every supernode that is not made yet: the finished ones that contribute to it next (first_pending_ and
  // next_). position_ is the first row of a finished one whose contribution is still missing.
  std::vector<int> first_pending_, next_;
  std::vector<std::size_t> position_;
  std::vector<std::size_t> relative_;
};

}  // namespace

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
