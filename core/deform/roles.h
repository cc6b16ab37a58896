// Roles: what the handles make of every component of the mesh, and which hard rows depend on
// others. Decided from the structure alone, never from a determinant or the luck of a factorisation
// [algorithm §3].
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "arap/base/cancel.h"
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
  std::vector<DependentRow> dependent;   // by row
};

// The hard rows that depend on others, by row. Rows on a single vertex, as area and oriented handles
// have, come before those inside a triangle; otherwise the earlier row decides. Linear in the rows,
// but for those inside triangles that share vertices with one another: O(m²·v) for m of those on v
// vertices that no single row holds. Fault: that of `cancel`, asked row by row.
Result<std::vector<DependentRow>> FindDependentRows(std::span<const Row> rows,
                                                    const CancelToken& cancel);

// Of a mesh with so many components. Costs and faults: those of FindDependentRows.
Result<Roles> DecideRoles(std::size_t components, std::span<const Row> rows,
                          const CancelToken& cancel);

}  // namespace arap
