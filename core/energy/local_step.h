// The local step: what every cell makes of a shape, frame by frame. Allocates nothing.
#pragma once

#include <span>

#include "core/energy/cells.h"
#include "core/energy/shape_view.h"

namespace arap {

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

}  // namespace arap
