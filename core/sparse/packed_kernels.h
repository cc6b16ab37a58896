// The triangular solves of a packed factor, on a few right-hand sides side by side. For this room
// only.
//
// A factor L Lᴴ is a list of panels: neighbouring columns with the same rows below them. A complex
// column counts as two real ones, and a complex right-hand side as two lanes (re, im), so that real
// and complex factors share the kernels that take the time. A lane's operations and their order do
// not depend on its neighbours, nor on the machine code: any number of lanes, plain or wide, gives
// the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
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

}  // namespace arap
