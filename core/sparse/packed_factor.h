// PackedFactor: a Cholesky factor laid out for solving one to four right-hand sides, as a frame and
// a new handle do. Twice to five times as fast there as the library's own solves, which are made
// for many. packed_kernels.h says how it is laid out.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "arap/base/crew.h"
#include "core/sparse/packed_kernels.h"

namespace arap {

// L of P A Pᵀ = L Lᴴ as supernodal CHOLMOD has it. Supernode s has columns first[s]…first[s + 1]−1
// and rows[rows_begin[s]]…; its own columns are the first of those. values[values_begin[s]]… is the
// dense block, column by column.
template <class Scalar>
struct Supernodes {
  std::span<const int> first, rows_begin, rows, values_begin;
  const Scalar* values = nullptr;
  std::span<const int> order;  // P: row k of the factor is row order[k] of A
};

// The points of a shape as a right-hand side, and where its solution goes; #n of each.
struct PointSolve {
  const std::complex<double>* right = nullptr;
  std::complex<double>* solution = nullptr;
};

// Scalar is double or std::complex<double>. Immutable: may be shared by threads, each with a
// scratch of its own.
template <class Scalar>
class PackedFactor {
 public:
  // Tells from where on the numbers have been read for the last time.
  using ReadFrom = std::function<void(const Scalar* begin)>;

  // `read_from` is called again and again, with less and less left, and may give memory back. Above four times
  // `part_numbers` the factor is cut into parts of at most so many numbers.
  explicit PackedFactor(const Supernodes<Scalar>& l, const ReadFrom& read_from = {},
                        std::size_t part_numbers = kPartNumbers);

  std::size_t size() const { return order_.size(); }
  std::span<const int> order() const { return order_; }
  std::size_t bytes() const;

  // Numbers that Solve needs as scratch.
  std::size_t ScratchSize() const { return 4 * (size() + panels_.copies) + kAlign; }
  // That one right-hand side after another may be computed by several threads.
  std::size_t parts() const { return panels_.parts.size(); }

  // Solves A `solution` = `right` (#n·columns, column by column). A column's bytes do not depend on
  // its neighbours, on the kernels or on the crew; columns go four at a time. Where `right` has few numbers
  // other than 0, half of the work is saved.
  void Solve(const Scalar* right, std::size_t columns, Scalar* solution, std::span<double> scratch,
             Crew* crew = nullptr, const PackedKernels& kernels = SolveKernels()) const;

  // For a real factor, the same for the x and the y of one shape or two: each has the bytes that
  // Solve gives its two columns.
  void SolvePoints(std::span<const PointSolve> shapes, std::span<double> scratch,
                   Crew* crew = nullptr, const PackedKernels& kernels = SolveKernels()) const;

 private:
  static constexpr std::size_t kAlign = 8;  // numbers in a cache line
  static constexpr std::size_t kPartNumbers = std::size_t{1} << 20u;

  template <class Visit>
  static void ForEachPanel(std::size_t width, Visit visit);
  static std::size_t NumbersOf(std::size_t width, std::size_t rows);  // of a panel
  double* Rows(std::span<double> scratch) const;                      // of Solve, aligned
  double* Pack(const Supernodes<Scalar>& l, std::size_t supernode, double* out);
  // Finds the parts and the top, before rows are packed. `first_panel` is per supernode, and the number of panels.
  void Cut(const Supernodes<Scalar>& l, std::span<const std::size_t> first_panel,
           std::size_t part_numbers);
  void AddPart(const Supernodes<Scalar>& l, std::span<const std::size_t> first_panel,
               std::span<const PanelRange> subtrees);
  // x := (L Lᴴ)⁻¹ x, with so many numbers to a row.
  void TakeThrough(PackedKernel kernel, std::size_t numbers, double* x, Crew* crew) const;

  std::vector<int> order_;
  PackedPanels panels_;
};

}  // namespace arap
