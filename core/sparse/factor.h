// Factor: a sparse Hermitian positive definite matrix, factored once and shared by many solvers.
//
// The only door to CHOLMOD. A const Factor may be used by many threads at once, each with a
// Workspace of its own [algorithm §6]. A job that factors one pattern over and over keeps a Factor
// of its own that is not const: Analyse once, then Again with each set of values.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/base/crew.h"
#include "arap/base/result.h"

namespace arap {

// How the factor is stored.
//
// kSupernodal: dense blocks for BLAS; the fastest to factor, and to solve many columns with.
// kSimplicial: column by column; good for small matrices.
// kPacked: factored like kSupernodal, then laid out anew (packed_factor.h); the fastest to solve a
// few columns with, or columns with few numbers other than 0. Every column has the same bytes
// whatever its neighbours.
enum class FactorLayout { kSupernodal, kSimplicial, kPacked };

class FactorData;

// Milliseconds of processor time that a factor took.
struct FactorTimes {
  double analysis = 0;  // order and fill
  double numbers = 0;   // the last Again
};

// Scratch of one thread's solves. Not thread-safe. May serve factors of different sizes and types
// in turn; memory is allocated when a solve is larger than those before.
class Workspace {
 public:
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  class Data;
  Data& data() { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

// Scalar is double or std::complex<double>.
template <class Scalar>
class Factor {
 public:
  // `lower` holds the lower triangle (#n×#n). `order` is a fill-reducing permutation from another
  // factor with a pattern around this one, or empty to find one. Faults: kNumerical when the matrix
  // is not positive definite; kOutOfMemory; kMeshTooLarge beyond the numbers that CHOLMOD counts.
  static Result<std::shared_ptr<const Factor>> Make(const Eigen::SparseMatrix<Scalar>& lower,
                                                    FactorLayout layout,
                                                    std::span<const int> order = {});
  ~Factor();

  // The half of Make that looks at the pattern alone (order, fill). Again must follow before the
  // first Solve. Faults: kOutOfMemory, kMeshTooLarge.
  static Result<std::unique_ptr<Factor>> Analyse(const Eigen::SparseMatrix<Scalar>& lower,
                                                 FactorLayout layout,
                                                 std::span<const int> order = {});
  // The other half: factors a matrix of the analysed pattern in place of the one before. Not
  // thread-safe. After a fault (kNumerical: not positive definite; kOutOfMemory) it must succeed
  // once before the next Solve.
  Status Again(const Eigen::SparseMatrix<Scalar>& lower);

  // Solves for `columns` right-hand sides stored one after the other (#n·columns). The answer is
  // laid out alike, lives in the workspace, and is valid until its next use. Fault: kOutOfMemory
  // (never where the workspace has seen as many numbers before). A packed factor of
  // more than four million numbers lets the crew take parts of it; the bytes are the same without one.
  Result<std::span<const Scalar>> Solve(std::span<const Scalar> right, std::size_t columns,
                                        Workspace& workspace, Crew* crew = nullptr) const;

  // The same for the x and y of `shapes` sets of points, of a real matrix that is packed; each set has
  // the bytes that Solve gives its two columns. No faults; std::bad_alloc as Solve's.
  std::span<const std::complex<double>> SolvePoints(std::span<const std::complex<double>> right,
                                                    std::size_t shapes, Workspace& workspace,
                                                    Crew* crew = nullptr) const;
  // The same for two sets of points that lie apart, in one pass over the factor: the answer of each
  // is in its own workspace, as if it had been alone.
  std::pair<std::span<const std::complex<double>>, std::span<const std::complex<double>>> SolveBoth(
      std::span<const std::complex<double>> one, Workspace& ones,
      std::span<const std::complex<double>> other, Workspace& others, Crew* crew = nullptr) const;

  std::size_t size() const;
  std::span<const int> order() const;
  std::size_t bytes() const;
  const FactorTimes& times() const { return times_; }

 private:
  explicit Factor(std::unique_ptr<FactorData> data);
  std::unique_ptr<FactorData> data_;
  FactorTimes times_;
};

}  // namespace arap
