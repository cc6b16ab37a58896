// The tables of CompiledHandles, and ConstraintSolver: how their rows bend a shape. For this folder
// only.
//
// Two ways lead to the same minimiser [algorithm §2]: the null-space form on the mesh's own factors
// (null_space_solver.h), cheap to compile and to edit, and a direct factorisation of mesh and
// handles together (direct_solver.h), cheaper per frame and per handle when there are many.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "arap/base/crew.h"
#include "arap/core/compiled_handles.h"
#include "core/deform/place.h"
#include "core/deform/registered_parts.h"
#include "core/deform/roles.h"
#include "core/sparse/factor.h"
#include "core/sparse/saddle.h"

namespace arap {

// Scratch of one stream. Solvers size what they use in Prepare and allocate nothing afterwards.
struct SolverScratch {
  std::vector<Complex> complex_right;  // #V, direct solver only
  Saddle<Complex>::Scratch similarity;
  Saddle<double>::Scratch rigid_x, rigid_y;
  Workspace workspace;
  Workspace correction;  // direct solver only
  Crew* crew = nullptr;  // of the frame that is under way, or none
};

// Immutable, shared by threads.
class ConstraintSolver {
 public:
  virtual ~ConstraintSolver() = default;

  virtual void Prepare(SolverScratch& scratch) const = 0;

  // Adds to `shape` (#V) what the rows ask of step 1 beyond what it has: `miss` is, per active row,
  // target minus the place that `shape` gives it. Fault: that of a
  // back-substitution.
  virtual Status AddSimilarity(std::span<const Complex> miss, std::span<Complex> shape,
                               SolverScratch& scratch) const = 0;

  // Step 2 is force → solution of rigid_factor() → AddRigid. CompleteForce adds the rows' share to
  // the edges' force (#V) and clears it where nothing moves; AddRigid adds the solution (#V) and
  // what the rows still lack to `shape`. `solution` may be empty where NeedsRigidSolve says no.
  virtual const Factor<double>& rigid_factor() const = 0;
  virtual bool NeedsRigidSolve(bool turned) const = 0;
  virtual void CompleteForce(std::span<const Complex> miss, std::span<Complex> force) const = 0;
  virtual Status AddRigid(std::span<const Complex> solution, std::span<const Complex> miss,
                          std::span<Complex> shape, SolverScratch& scratch) const = 0;

  virtual std::size_t bytes() const = 0;
};

// Where `shape` has the row's point.
inline Complex PointOf(const Row& row, std::span<const Complex> shape) {
  Complex p = 0;
  for (std::size_t k = 0; k < 3; ++k) p += row.weight[k] * shape[row.vertex[k]];
  return p;
}

// Finds the handles of a set by their ids. A sorted order rather than a hash table: clients choose the ids, and must not be able to choose
// slow ones. Immutable.
class HandleIndex {
 public:
  HandleIndex() = default;

  // `handles` have different ids. O(n log n).
  explicit HandleIndex(std::span<const PlacedHandle> handles) : by_id_(handles.size()) {
    std::iota(by_id_.begin(), by_id_.end(), 0u);
    std::sort(by_id_.begin(), by_id_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return handles[a].handle.id < handles[b].handle.id;
    });
  }

  // Where `id` is among `handles`, those that the index was made of. compare(a, b) says like
  // std::string_view::compare how two ids stand to each other; it is called at most
  // ⌊log2 n⌋ + 2 times.
  template <class Compare>
  std::optional<std::size_t> Find(std::span<const PlacedHandle> handles, std::string_view id,
                                  Compare compare) const {
    const auto at = std::partition_point(by_id_.begin(), by_id_.end(), [&](std::uint32_t i) {
      return compare(handles[i].handle.id, id) < 0;
    });
    if (at == by_id_.end() || compare(handles[*at].handle.id, id) != 0) return std::nullopt;
    return *at;
  }

  std::size_t bytes() const { return by_id_.size() * sizeof(std::uint32_t); }

 private:
  std::vector<std::uint32_t> by_id_;  // places in the set, in the order of their ids
};

class Responses;

struct CompiledHandlesParts {
  std::shared_ptr<const RegisteredMesh> mesh;
  HandleSolver choice = HandleSolver::kAuto;
  std::vector<PlacedHandle> handles;
  HandleIndex index;      // of the handles
  std::vector<Row> rows;  // by handle
  RowCount count;
  Roles roles;
  std::vector<double> depths;  // #V, or empty: see VertexDepths

  // Of every row, also of rows that are not active, because an edit may wake them. Empty when
  // direct.
  std::shared_ptr<const Responses> responses;
  std::shared_ptr<const ConstraintSolver> solver;
};

// Whether a set with so many rows is factored together with its mesh.
inline bool FactorsDirectly(std::size_t rows, HandleSolver choice) {
  return choice == HandleSolver::kDirect || (choice == HandleSolver::kAuto && rows > kDirectRows);
}

// What VertexDepths shows. O(#V) per handle with a depth, about 1 ns a vertex. Fault: that of
// `cancel`, asked handle by handle.
Result<std::vector<double>> ComputeDepths(const RegisteredMeshParts& mesh,
                                          std::span<const PlacedHandle> handles,
                                          const CancelToken& cancel);

}  // namespace arap
