// The layout of a packed factor, and the loops that solve with it. For this folder only.
//
// A factor L Lᴴ is a list of panels: neighbouring columns with the same rows below them. Real
// factors take several columns at once, and pairs of right-hand sides, such as the x and y of a
// shape; complex ones several right-hand sides, each as two lanes (re, im). The operations of a
// right-hand side and their order do not depend on its neighbours, nor on the machine code: any
// number of them, with registers of any width, gives the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

namespace arap {

// Real columns of a panel: as many numbers as fill a cache line and the widest register.
inline constexpr std::size_t kPanelWidth = 8;

struct Panel {
  std::uint32_t first = 0;  // its first column
  std::uint32_t width = 0;  // its columns; real, or complex ones
  std::uint32_t rows = 0;   // where its rows below begin, in PackedPanels::rows
  std::uint32_t count = 0;  // of those rows
  std::size_t values = 0;   // where its numbers begin, in PackedPanels::values
};

struct FreeNumbers {
  void operator()(double* numbers) const { std::free(numbers); }
};

// Neighbouring panels.
struct PanelRange {
  std::size_t begin = 0, end = 0;
};

// Whole subtrees of the elimination tree. Its panels reach rows of their own and rows of the top, of which it has
// copies beyond the #n rows of a right-hand side: parts have no row in common.
struct PanelPart {
  std::vector<PanelRange> panels;
  std::vector<std::uint32_t> above;  // the rows of the top, ascending
  std::size_t copies = 0;            // the row in which the copy of the first one is
};

// Numbers of a panel: the inverse of its diagonal block (lower triangle, row by row), then the rows
// below, each with all columns. A complex number is (re, im). In a real factor both are filled up
// with 0: the first so that the second begin on a cache line, and each row to 4 or 8 numbers.
struct PackedPanels {
  std::vector<Panel> panels;        // by first column
  std::vector<std::uint32_t> rows;  // in a part, those of the top are its copies
  // A factor of many numbers is cut into parts by these numbers alone; of another all panels are the top.
  std::vector<PanelPart> parts;
  std::vector<PanelRange> top;
  std::size_t copies = 0;                         // of rows, of all parts
  std::unique_ptr<double[], FreeNumbers> values;  // on a cache line
  std::size_t numbers = 0;                        // of `values`
};

// Numbers of a row of a real panel, with those that are filled up.
constexpr std::size_t Filled(std::size_t width) { return width <= 4 ? 4 : 8; }

// Numbers of its diagonal block, with those up to where the rows begin.
constexpr std::size_t Diagonal(std::size_t width) { return (width * (width + 1) / 2 + 7) / 8 * 8; }

// Takes x through a range of panels in place: x := L⁻¹ x forwards, x := L⁻ᴴ x backwards. x is #n×lanes, a row's lanes
// together, and the copies of all parts.
using PackedKernel = void (*)(const PackedPanels& factor, PanelRange range, bool forward,
                              double* x);
struct PackedKernels {
  PackedKernel real2, real4;
  PackedKernel complex1, complex2;  // 2 lanes: one right-hand side
};

// Those that this processor has: the plain one first, the best last.
std::span<const PackedKernels> SolveKernelsHere();

// The best of this processor.
const PackedKernels& SolveKernels();

}  // namespace arap
