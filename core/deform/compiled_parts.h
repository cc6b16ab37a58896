// The tables of CompiledHandles, for this room only.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "core/deform/constraint_solver.h"
#include "core/deform/place.h"
#include "core/deform/responses.h"

namespace arap {

// What the handles make of a component [algorithm §5].
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

struct CompiledHandlesParts {
  std::shared_ptr<const RegisteredMesh> mesh;
  HandleSolver choice = HandleSolver::kAuto;
  std::vector<PlacedHandle> handles;
  std::vector<Row> rows;  // by handle

  // Of every row, also of rows that are not active, because an edit may wake them. Empty when
  // direct.
  std::shared_ptr<const Responses> responses;

  std::vector<ComponentRole> roles;        // per component
  std::vector<std::uint32_t> active_slot;  // per component: its number among the active, or kNone
  std::size_t active_components = 0;
  std::vector<std::size_t> active_rows;  // the rows that the solver has, in its order
  std::vector<DependentRow> dependent;
  std::shared_ptr<const ConstraintSolver> solver;
};

}  // namespace arap
