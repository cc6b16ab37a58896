// PackedFactor: a Cholesky factor laid out for solving one to four right-hand sides, as a frame and
// a new handle do. Twice to five times as fast there as the library's own solves, which are made
// for many.
//
// A factor L Lᴴ is a list of panels: neighbouring columns with the same rows below them. A complex
// column counts as two real ones, and a complex right-hand side as two lanes (re, im), so that real
// and complex factors share the kernels that take the time. A lane's operations and their order do
// not depend on its neighbours, nor on the machine code: any number of lanes, plain or wide, gives
// the same bytes.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace arap {

// Real columns of a panel: as many sums as the registers of every processor hold.
inline constexpr std::size_t kPanelWidth = 8;

struct Panel {
  std::uint32_t first = 0;  // its first column
  std::uint32_t width = 0;  // its columns; real, or complex ones
  std::uint32_t rows = 0;   // where its rows below begin, in PackedPanels::rows
  std::uint32_t count = 0;  // of those rows
  std::size_t values = 0;   // where its numbers begin, in PackedPanels::values
};

// Numbers of a panel: the inverse of its diagonal block (lower triangle, row by row), then the rows
// below, each with all columns. A complex number is (re, im).
struct PackedPanels {
  std::vector<Panel> panels;  // by first column
  std::vector<std::uint32_t> rows;
  std::unique_ptr<double[]> values;
  std::size_t numbers = 0;  // of `values`
};

// x := (L Lᴴ)⁻¹ x in place. x is #n×lanes, a row's lanes together.
struct PackedKernels {
  void (*real2)(const PackedPanels& factor, double* x);
  void (*real4)(const PackedPanels& factor, double* x);
  void (*complex1)(const PackedPanels& factor, double* x);  // 2 lanes: one right-hand side
  void (*complex2)(const PackedPanels& factor, double* x);
};

// The best of this processor.
const PackedKernels& SolveKernels();

// The plain one: every processor has it. For tests.
const PackedKernels& PlainSolveKernels();

// L of P A Pᵀ = L Lᴴ as supernodal CHOLMOD has it. Supernode s has columns first[s]…first[s + 1]−1
// and rows[rows_begin[s]]…; its own columns are the first of those. values[values_begin[s]]… is the
// dense block, column by column.
template <class Scalar>
struct Supernodes {
  std::span<const int> first, rows_begin, rows, values_begin;
  const Scalar* values = nullptr;
  std::span<const int> order;  // P: row k of the factor is row order[k] of A
};

// Scalar is double or std::complex<double>. Immutable: may be shared by threads, each with a
// scratch of its own.
template <class Scalar>
class PackedFactor {
 public:
  // Tells from where on the numbers have been read for the last time.
  using ReadFrom = std::function<void(const Scalar* begin)>;

  // `read_from` is called again and again, with less and less left, and may give memory back.
  explicit PackedFactor(const Supernodes<Scalar>& l, const ReadFrom& read_from = {});

  std::size_t size() const { return order_.size(); }
  std::span<const int> order() const { return order_; }
  std::size_t bytes() const;

  // Numbers that Solve needs as scratch.
  std::size_t ScratchSize() const { return 4 * size() + kAlign; }

  // Solves A `solution` = `right` (#n·columns, column by column). A column's bytes do not depend on
  // its neighbours or on the kernels; columns go four at a time. Where `right` has few numbers
  // other than 0, half of the work is saved.
  void Solve(const Scalar* right, std::size_t columns, Scalar* solution, std::span<double> scratch,
             const PackedKernels& kernels = SolveKernels()) const;

 private:
  static constexpr std::size_t kAlign = 8;  // numbers in a cache line

  double* Pack(const Supernodes<Scalar>& l, std::size_t supernode, double* out);

  std::vector<int> order_;
  PackedPanels panels_;
};

}  // namespace arap
