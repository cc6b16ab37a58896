// CompiledHandles: a handle set on a registered mesh, ready to deform [II09 §6 "compilation"].
//
// Compilation does not factor the mesh again: it costs one back-substitution per constraint row and
// one small dense factorisation, the null-space form [algorithm §2].
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/registered_mesh.h"
#include "arap/model/handle.h"

namespace arap {

struct CompiledHandlesParts;

// How the rows are solved. Both give the same shapes; kAuto takes whichever is cheaper.
enum class HandleSolver {
  kAuto,
  kNullSpace,  // one back-substitution per row; an edit costs the added rows only
  kDirect,     // mesh and handles factored together; an edit factors again
};

// Above this many constraint rows kAuto factors directly: there both the compilation and the frame
// are cheaper that way; docs/algorithm.md, section 2, has the measurement.
inline constexpr std::size_t kDirectRows = 96;

// The most constraint rows that a set on a mesh of so many vertices may have: only areas that overlap
// many times have more.
constexpr std::size_t MostRows(std::size_t vertices) { return 16 * vertices + 100'000; }

// Immutable, safe to share between threads. Keeps its mesh alive.
//
// A handle has one constraint row; an oriented one has the three of its triangle, an area handle
// one per vertex that it holds. Handles are numbered in the order given.
class CompiledHandles {
 public:
  // Finds the handles on the mesh and solves for their rows. The numbers of a handle must be within
  // the bounds that arap/model/handle.h gives; the ids are compared, but not otherwise looked at.
  //
  // Faults, with the field "handles[i]…" and the number of the handle in `Fault::elements`:
  //   kDuplicateHandle; kIndexOutOfRange for a vertex or triangle that the mesh has not;
  //   kHandleOutside for a position outside the mesh (detail "distance") or a vertex without a
  //   triangle; kInvalidOption for a number out of its bounds; kTooManyHandles beyond MostRows; kNumerical; kOutOfMemory; whatever `cancel`
  //   answers between blocks of rows.
  static Result<std::shared_ptr<const CompiledHandles>> Compile(
      std::shared_ptr<const RegisteredMesh> mesh, const std::vector<Handle>& handles,
      const CancelToken& cancel = {}, HandleSolver solver = HandleSolver::kAuto);

  // A new set with `remove` taken out, then `add` appended. This set is not changed. Costs the
  // back-substitutions of the added rows only; factors again when direct. Faults: kUnknownHandle
  // (field "remove") and those of Compile, with the field "add[i]…".
  Result<std::shared_ptr<const CompiledHandles>> Edit(std::span<const std::string> remove,
                                                      const std::vector<Handle>& add,
                                                      const CancelToken& cancel = {}) const;

  ~CompiledHandles();
  CompiledHandles(const CompiledHandles&) = delete;
  CompiledHandles& operator=(const CompiledHandles&) = delete;

  const std::shared_ptr<const RegisteredMesh>& mesh() const;
  const std::vector<PlacedHandle>& handles() const;  // in the order given
  // The number of the handle with this id. O(log n).
  std::optional<std::size_t> Find(std::string_view id) const;
  // Where every handle is at rest: as targets they give the rest shape.
  std::vector<Target> RestTargets() const;
  // What Deformer::Update would say of the targets without taking the frame: the faults of one per
  // handle that is not acceptable, and kConflictingHandles when hard handles cannot all meet
  // theirs. Linear in rows(); free, and without any check, unless hard handles depend on one
  // another.
  Status CheckHard(std::span<const Target> targets) const;

  std::size_t rows() const;                // constraint rows
  bool direct() const;                     // whether mesh and handles were factored together
  std::size_t bytes() const;               // held beside the mesh; what sets share counts in each
  std::size_t resting_components() const;  // without a handle: they stay at rest
  std::size_t translating_components() const;  // with one distinct handle: they only move
  std::vector<Warning> warnings() const;       // snapped handles, resting components, …

  // For the rest of the core.
  const CompiledHandlesParts& parts() const { return *parts_; }

 private:
  explicit CompiledHandles(std::unique_ptr<const CompiledHandlesParts> parts);
  std::unique_ptr<const CompiledHandlesParts> parts_;
};

}  // namespace arap
