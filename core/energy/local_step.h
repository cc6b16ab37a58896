// The local step: what every cell makes of a shape, frame by frame. Allocates nothing.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/energy/cells.h"

namespace arap {

// A shape as two arrays (#V each), because the rigid solve takes x and y as two right-hand sides.
// Views: valid as long as the arrays.
struct ConstShapeView {
  const double* x;
  const double* y;
};
struct ShapeView {
  double* x;
  double* y;
};

// Below this part of its own size a cell's similarity has no direction: its targets fell into one
// point.
inline constexpr double kNoDirection = 1e-13;

// Adds Σ w (t̂_c − t̄) e to the right-hand side `f` of the rigid step: +at b, −at a. t̂ is the
// rotation of each cell's best similarity to `v`; t̄ is `mean[component]`, which also stands in
// where a cell has no direction (1 when it is 0). Working with the difference keeps rigid motions
// exact.
void AddRotatedEdges(const Cells& cells, ConstShapeView v, std::span<const Complex> mean,
                     ShapeView f);

// Σ_c Σ_energy w |(v_b − v_a) − t̂_c e|², with t̂ the rotation that fits `v` best in each cell.
double RigidEnergy(const Cells& cells, ConstShapeView v);

// The arithmetic on a few hundred hinges or faces at a time, written so that the compiler can take
// several at once. For this folder only.
//
// There is one body per kernel and two machine codes of it, chosen once by what the processor can
// do. Every lane does the same operations in the same order: both give the same bytes.
inline constexpr std::size_t kKernelBlock = 256;
using KernelColumn = std::array<double, kKernelBlock>;

struct LocalKernels {
  // w ((t̂ − mean) e) of hinges begin… (both cells added up), from i to j.
  void (*hinge_forces)(const HingeTable& table, std::size_t begin, std::size_t count,
                       ConstShapeView v, Complex mean, Complex fallback, KernelColumn& x,
                       KernelColumn& y);
  void (*hinge_energies)(const HingeTable& table, std::size_t begin, std::size_t count,
                         ConstShapeView v, KernelColumn& energy);
  // t̂ − mean of each face.
  void (*face_turns)(const FaceTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
                     Complex mean, Complex fallback, KernelColumn& x, KernelColumn& y);
  void (*face_energies)(const FaceTable& table, std::size_t begin, std::size_t count,
                        ConstShapeView v, KernelColumn& energy);
};

// The best of this processor.
const LocalKernels& Kernels();

// The plain one: every processor has it. For tests.
const LocalKernels& PlainKernels();

}  // namespace arap
