// PackedFactor: a Cholesky factor laid out for solving one to four right-hand sides, as a frame and
// a new handle do. Twice to five times as fast there as the library's own solves, which are made
// for many. packed_kernels.h says how it is laid out.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "arap/base/crew.h"
#include "core/sparse/packed_kernels.h"
#include "core/sparse/supernodal.h"

namespace arap {

// The points of a shape as a right-hand side, and where its solution goes; #n of each.
struct PointSolve {
  const std::complex<double>* right = nullptr;
  std::complex<double>* solution = nullptr;
};

// Scalar is double or std::complex<double>. Once packed it is immutable: may be shared by threads, each with a
// scratch of its own.
template <class Scalar>
class PackedFactor {
 public:
  // Lays the panels out and allocates their memory; Pack gives them numbers. A factor of more than four times
  // `part_numbers` numbers is cut into parts of at most `part_numbers` each, which several threads can solve with.
  explicit PackedFactor(const SupernodalPattern& l, std::size_t part_numbers = kPartNumbers);

  // Before Pack, the dense block of every supernode s of L is written to blocks() + block_begin()[s]. Blocks share the
  // memory of the panels and lie in the order in which Pack takes them, the last supernode first. So there is never a
  // second copy of a factor, and the system provides each of its pages once.
  std::span<const int> block_begin() const { return block_begin_; }
  Scalar* blocks() { return reinterpret_cast<Scalar*>(panels_.values.get() + room_); }

  // Makes panels of the blocks, which are lost. Can be repeated with new blocks.
  void Pack(const SupernodalPattern& l);

  // Gives back the memory that blocks need beyond that of the panels. Pack must not be called again.
  void GiveBackRoom();

  std::size_t size() const { return order_.size(); }
  std::span<const int> order() const { return order_; }
  std::size_t bytes() const;

  // Numbers that Solve needs as scratch.
  std::size_t ScratchSize() const { return 4 * (size() + panels_.copies) + kAlign; }
  // How many parts several threads can take at the same time; 0 for a factor that is not cut.
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
  // Writes the numbers of a panel that begins at column `begin` of a block of so many rows.
  void PackPanel(const Panel& panel, const Scalar* block, std::size_t begin, std::size_t height);
  // Finds the parts and the top, before rows are packed. `first_panel` is per supernode, and the number of panels.
  void Cut(const SupernodalPattern& l, std::span<const std::size_t> first_panel,
           std::size_t part_numbers);
  void AddPart(const SupernodalPattern& l, std::span<const std::size_t> first_panel,
               std::span<const PanelRange> subtrees);
  // x := (L Lᴴ)⁻¹ x, with so many numbers to a row.
  void TakeThrough(PackedKernel kernel, std::size_t numbers, double* x, Crew* crew) const;

  std::vector<int> order_;
  PackedPanels panels_;
  std::vector<int> block_begin_;
  // Numbers before the first block, so that no panel reaches a block that is not packed.
  std::size_t room_ = 0;
  std::size_t allocated_ = 0;  // numbers
};

}  // namespace arap
