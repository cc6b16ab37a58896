// The tables of CompiledHandles, for this room only.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/deform/compiled_handles.h"
#include "core/deform/place.h"
#include "core/deform/saddle.h"

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

class CompiledHandlesParts {
 public:
  using Columns = Eigen::MatrixXd;

  std::shared_ptr<const RegisteredMesh> mesh;
  std::vector<PlacedHandle> handles;
  std::vector<Row> rows;  // by handle

  // Z of every row, #V×#rows, also of rows that are not active: an edit may wake them.
  Columns z1_real, z1_imag;  // step 1
  Columns z2;                // step 2

  std::vector<ComponentRole> roles;        // per component
  std::vector<std::uint32_t> active_slot;  // per component: its place in the null space, or kNone
  std::size_t active_components = 0;
  std::vector<std::size_t> active_rows;  // the rows of the dense systems
  std::vector<DependentRow> dependent;
  Saddle<Complex> saddle1;  // null space per component: 1 and p − centre
  Saddle<double> saddle2;   // null space per component: 1
};

}  // namespace arap
