// Roles: what the handles make of every component of the mesh, and which hard rows depend on
// others. Decided from the structure alone, never from a determinant or the luck of a factorisation
// [algorithm §3].
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/deform/place.h"

namespace arap {

enum class ComponentRole {
  kResting,      // no handle: stays at rest
  kTranslating,  // one distinct point: follows it without turning
  kActive,       // two or more: the algorithm
};

// A hard row that other hard rows determine: target = Σ coefficient · target(row). Checked every
// frame.
struct DependentRow {
  std::size_t row = 0;
  std::vector<std::pair<std::size_t, double>> combination;
};

struct Roles {
  std::vector<ComponentRole> of;           // per component
  std::vector<std::uint32_t> active_slot;  // per component: its number among the active, or kNone
  std::size_t active_components = 0;
  std::vector<std::size_t> active_rows;  // the rows that the solver has, in its order
  std::vector<DependentRow> dependent;
};

// Of a mesh with so many components. O(h²·v) for h hard rows that touch v vertices.
Roles DecideRoles(std::size_t components, std::span<const Row> rows);

}  // namespace arap
