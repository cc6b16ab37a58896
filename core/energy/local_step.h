// The local step: what every cell makes of a shape, frame by frame. Allocates nothing.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/crew.h"
#include "core/energy/cells.h"

namespace arap {

// A shape as two arrays (#V each), for work whose unknowns lie so. Views: valid as long as the arrays.
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

// Adds Σ w (t̂_c − t̄) e to the right-hand side `force` (#V) of the rigid step: +at b, −at a. t̂ is the
// rotation of each cell's best similarity to `shape` (#V); t̄ is `mean[component]`, which also stands
// in where a cell has no direction (1 when it is 0). Working with the difference keeps rigid motions
// exact.
void AddRotatedEdges(const Cells& cells, std::span<const Complex> shape,
                     std::span<const Complex> mean, std::span<Complex> force);

// The same bytes with a crew: it computes the forces of some ten thousand cells while those before them are added, in
// their order. They wait in `room`, which is made as large as it has to be (2 MB) by the first call. Stars are added
// by this thread alone.
void AddRotatedEdges(const Cells& cells, std::span<const Complex> shape,
                     std::span<const Complex> mean, std::span<Complex> force, Crew* crew,
                     std::vector<double>& room);

// Σ_c Σ_energy w |(v_b − v_a) − t̂_c e|², with t̂ the rotation that fits `shape` best in each cell. A crew takes parts of
// it, and of hinges and faces only; the sum is the same without one.
double RigidEnergy(const Cells& cells, std::span<const Complex> shape, Crew* crew = nullptr);

// The arithmetic on a hundred hinges or faces at a time, written so that the compiler can take
// several at once. For the energies: this folder and core/flatten/injective.
//
// There is one body per kernel and a few machine codes of it, chosen once by what the processor can
// do. Every lane does the same operations in the same order: all give the same bytes.
inline constexpr std::size_t kKernelBlock = 128;
using KernelColumn = std::array<double, kKernelBlock>;

// What a block of triangles pulls at its second and third corners; the first is pulled against both.
struct CornerPulls {
  KernelColumn x1, y1, x2, y2, energy;
};

// Adds the pulls of triangles begin… of a table with their corners v0, v1, v2 to `pull` (#V), and
// answers `energy` with theirs added, one after the other.
template <class Table>
double AddPulls(const Table& table, std::size_t begin, std::size_t count, const CornerPulls& p,
                double energy, ShapeView pull) {
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = table.v0[begin + k], j = table.v1[begin + k], l = table.v2[begin + k];
    energy += p.energy[k];
    pull.x[i] -= p.x1[k] + p.x2[k];
    pull.y[i] -= p.y1[k] + p.y2[k];
    pull.x[j] += p.x1[k];
    pull.y[j] += p.y1[k];
    pull.x[l] += p.x2[k];
    pull.y[l] += p.y2[k];
  }
  return energy;
}

// Of cells begin…, where a shape is pairs of numbers and there are at most kKernelBlock cells.
struct LocalKernels {
  // w ((t̂ − mean) e) of hinges (both cells added up), from i to j.
  void (*hinge_forces)(const HingeTable& table, std::size_t begin, std::size_t count,
                       const double* shape, Complex mean, Complex fallback, KernelColumn& x,
                       KernelColumn& y);
  void (*hinge_energy)(const HingeTable& table, std::size_t begin, std::size_t count,
                       const double* shape, double& energy);
  // What the three edges of each face, turned by t̂ − mean, exert on corners 1 and 2; corner 0 gets the
  // opposite of both.
  void (*face_forces)(const FaceTable& table, std::size_t begin, std::size_t count,
                      const double* shape, Complex mean, Complex fallback, KernelColumn& x1,
                      KernelColumn& y1, KernelColumn& x2, KernelColumn& y2);
  void (*face_energy)(const FaceTable& table, std::size_t begin, std::size_t count,
                      const double* shape, double& energy);
};

// Those that this processor has: the plain one first, the best last.
std::span<const LocalKernels> LocalKernelsHere();

}  // namespace arap
