// The tables of CompiledHandles, for this folder only.
#pragma once

#include <memory>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "core/deform/constraint_solver.h"
#include "core/deform/handle_index.h"
#include "core/deform/place.h"
#include "core/deform/roles.h"

namespace arap {

class Responses;

struct CompiledHandlesParts {
  std::shared_ptr<const RegisteredMesh> mesh;
  HandleSolver choice = HandleSolver::kAuto;
  std::vector<PlacedHandle> handles;
  HandleIndex index;      // of the handles
  std::vector<Row> rows;  // by handle
  Roles roles;

  // Of every row, also of rows that are not active, because an edit may wake them. Empty when
  // direct.
  std::shared_ptr<const Responses> responses;
  std::shared_ptr<const ConstraintSolver> solver;
};

}  // namespace arap
