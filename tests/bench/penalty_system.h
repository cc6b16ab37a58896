// A sparse system to which penalty rows are added and which is then factored: CHOLMOD as it comes.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <Eigen/SparseCore>

namespace arap::bench {

// Aborts when CHOLMOD fails. Not thread-safe.
class PenaltySystem {
 public:
  // `lower`: lower triangle (#n×#n), positive semi-definite. Orders it and analyses the factor.
  // Supernodal factors are made fast, simplicial ones solve one or two columns fast.
  PenaltySystem(Eigen::SparseMatrix<double> lower, bool supernodal);
  ~PenaltySystem();
  PenaltySystem(const PenaltySystem&) = delete;
  PenaltySystem& operator=(const PenaltySystem&) = delete;

  void Clear();  // back to `lower`
  // Adds to the entry (row, column), which must lie in the pattern; ignores the upper triangle.
  void Add(Eigen::Index row, Eigen::Index column, double value);
  void Factor();

  // For `columns` right-hand sides stored one after the other; the answer is laid out alike and
  // valid until the next call.
  const double* Solve(std::span<const double> right, std::size_t columns);

  std::size_t bytes() const;

 private:
  class Data;
  std::unique_ptr<Data> data_;
};

}  // namespace arap::bench
