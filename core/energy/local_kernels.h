// The arithmetic of the local step on a few hundred hinges or faces at a time, written so that the
// compiler can take several at once. For this room only.
//
// There is one body per kernel and two machine codes of it, chosen once by what the processor can
// do. Every lane does the same operations in the same order: both give the same bytes.
#pragma once

#include <array>
#include <cstddef>

#include "core/energy/cells.h"
#include "core/energy/shape_view.h"

namespace arap {

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
