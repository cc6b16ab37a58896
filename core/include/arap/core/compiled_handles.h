// CompiledHandles: a handle set on a registered mesh, ready to deform [II09 §6 "compilation"].
//
// Compilation does not factor the mesh matrices again: it costs one back-substitution per
// constraint row and one small dense factorisation (null-space form, algorithm §4).
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
// are cheaper that way (docs/algorithm.md has the measurement).
inline constexpr std::size_t kDirectRows = 96;

// Immutable, safe to share between threads.
class CompiledHandles {
 public:
  // Faults: kDuplicateHandle, kIndexOutOfRange, kHandleOutside (with the distance), kInvalidOption,
  // and whatever `cancel` answers. `Fault::field` names "handles[i]…", `Fault::elements` the handle
  // indices.
  static Result<std::shared_ptr<const CompiledHandles>> Compile(
      std::shared_ptr<const RegisteredMesh> mesh, std::vector<Handle> handles,
      const CancelToken& cancel = {}, HandleSolver solver = HandleSolver::kAuto);

  // A new set with `remove` taken out and `add` appended, in that order. Costs the
  // back-substitutions of the added rows only. Faults: kUnknownHandle and those of Compile; this
  // set is not changed.
  Result<std::shared_ptr<const CompiledHandles>> Edit(std::span<const std::string> remove,
                                                      std::vector<Handle> add,
                                                      const CancelToken& cancel = {}) const;

  ~CompiledHandles();
  CompiledHandles(const CompiledHandles&) = delete;
  CompiledHandles& operator=(const CompiledHandles&) = delete;

  const std::shared_ptr<const RegisteredMesh>& mesh() const;
  const std::vector<PlacedHandle>& handles() const;  // in the order given
  std::optional<std::size_t> Find(std::string_view id) const;
  std::vector<Target> RestTargets() const;  // one per handle
  // Without a frame: kConflictingHandles when hard handles cannot all meet these targets (one per
  // handle, finite). Linear in rows(), and free unless hard handles depend on one another.
  Status CheckHard(std::span<const Target> targets) const;
  std::size_t rows() const;  // constraint rows
  bool direct() const;       // whether it factored directly
  std::size_t bytes() const;
  std::size_t resting_components() const;      // without handles: they stay at rest
  std::size_t translating_components() const;  // with one distinct handle
  std::vector<Warning> warnings() const;
  // Depth of every vertex, and triangles back to front. Empty when no handle has a depth.
  std::vector<double> VertexDepths() const;
  std::vector<std::uint32_t> DrawOrder() const;

  // For the rest of this room.
  const CompiledHandlesParts& parts() const { return *parts_; }

 private:
  explicit CompiledHandles(std::unique_ptr<const CompiledHandlesParts> parts);
  std::unique_ptr<const CompiledHandlesParts> parts_;
};

}  // namespace arap
