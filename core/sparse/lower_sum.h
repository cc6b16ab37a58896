// LowerSum: the lower triangle of a matrix as a sum of entries, which come in any order.
//
// First the places of all entries are counted, then the entries are added, no more than were counted for their column. Those
// of one place are added up in the order in which they come. It takes a fraction of the time and memory of triplets.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

namespace arap {

template <class Scalar>
class LowerSum {
 public:
  // Rows and columns of `fixed` vertices will be those of the identity.
  explicit LowerSum(const std::vector<bool>& fixed)
      : fixed_(fixed),
        any_fixed_(std::find(fixed.begin(), fixed.end(), true) != fixed.end()),
        begin_(fixed.size() + 1, 0),
        diagonal_(fixed.size(), Scalar(0)) {}

  void Count(std::uint32_t a, std::uint32_t b) {
    if (a != b && Free(a, b)) ++begin_[std::min(a, b) + 1];
  }
  void EndOfCounting() {
    for (std::size_t v = 0; v + 1 < begin_.size(); ++v) begin_[v + 1] += begin_[v];
    next_.assign(begin_.begin(), begin_.end() - 1);
    rows_ = std::make_unique_for_overwrite<int[]>(begin_.back());
    values_ = std::make_unique_for_overwrite<Scalar[]>(begin_.back());
  }

  // row ≥ column
  void Add(std::uint32_t row, std::uint32_t column, Scalar value) {
    if (row == column) {
      diagonal_[row] += value;
    } else if (Free(row, column)) {
      const std::size_t at = next_[column]++;
      rows_[at] = static_cast<int>(row);
      values_[at] = value;
    }
  }

  Eigen::SparseMatrix<Scalar> Take() {
    const std::size_t n = fixed_.size();
    const auto size = static_cast<Eigen::Index>(n);
    Eigen::SparseMatrix<Scalar> matrix(size, size);
    int* outer = matrix.outerIndexPtr();
    // In place: the numbers of a column move to the left.
    std::vector<std::size_t> place(n, 0);  // of a row in the column that is summed up
    std::size_t end = 0;
    for (std::size_t c = 0; c < n; ++c) {
      const std::size_t start = end;
      for (std::size_t at = begin_[c]; at < next_[c]; ++at) {
        const int row = rows_[at];
        std::size_t& known = place[static_cast<std::size_t>(row)];
        if (known >= start && known < end && rows_[known] == row) {
          values_[known] += values_[at];
        } else {
          known = end;
          rows_[end] = row;
          values_[end++] = values_[at];
        }
      }
      Sort(start, end);
      outer[c + 1] = static_cast<int>(end + c + 1);
    }
    matrix.resizeNonZeros(static_cast<Eigen::Index>(end + n));
    outer = matrix.outerIndexPtr();
    for (std::size_t c = 0, from = 0; c < n; ++c) {
      auto to = static_cast<std::size_t>(outer[c]);
      matrix.innerIndexPtr()[to] = static_cast<int>(c);
      matrix.valuePtr()[to++] = fixed_[c] ? Scalar(1) : diagonal_[c];
      for (; to < static_cast<std::size_t>(outer[c + 1]); ++to, ++from) {
        matrix.innerIndexPtr()[to] = rows_[from];
        matrix.valuePtr()[to] = values_[from];
      }
    }
    return matrix;
  }

 private:
  bool Free(std::uint32_t a, std::uint32_t b) const {
    return !any_fixed_ || (!fixed_[a] && !fixed_[b]);
  }

  // By row. Most columns have a few numbers.
  void Sort(std::size_t begin, std::size_t end) {
    constexpr std::size_t kFew = 32;
    if (end - begin > kFew) {
      std::vector<std::pair<int, Scalar>> column;
      for (std::size_t at = begin; at < end; ++at) column.emplace_back(rows_[at], values_[at]);
      std::sort(column.begin(), column.end(),
                [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [row, value] : column) rows_[begin] = row, values_[begin++] = value;
      return;
    }
    for (std::size_t i = begin + 1; i < end; ++i) {
      const int row = rows_[i];
      const Scalar value = values_[i];
      std::size_t to = i;
      for (; to > begin && rows_[to - 1] > row; --to) {
        rows_[to] = rows_[to - 1];
        values_[to] = values_[to - 1];
      }
      rows_[to] = row;
      values_[to] = value;
    }
  }

  const std::vector<bool>& fixed_;
  const bool any_fixed_;
  std::vector<std::size_t> begin_, next_;  // of a column's entries; the next one of it
  std::unique_ptr<int[]> rows_;
  std::unique_ptr<Scalar[]> values_;
  std::vector<Scalar> diagonal_;
};

}  // namespace arap
