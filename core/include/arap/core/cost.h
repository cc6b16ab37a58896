// Cost: what a piece of work will take, told before it is done. A server admits, reserves and
// schedules by it.
//
// Fitted to measurements over a grid of sizes (docs/operations.md has the table and the machine):
// within 2× of the processor time and 1.3× of the memory there. All of these are cheap themselves;
// thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"
#include "arap/model/deform.h"
#include "arap/model/energy.h"

namespace arap {

struct Cost {
  double milliseconds = 0;  // of processor time
  std::size_t bytes = 0;    // at the peak, beside what is there before; what is kept is less

  double seconds() const { return milliseconds * 1e-3; }
};

// The rows of a handle set, by what they cost.
struct RowCount {
  std::size_t rows = 0;    // all
  std::size_t inside = 0;  // the hard ones inside triangles
  std::size_t held = 0;    // the hard ones on a single vertex
  std::size_t depths = 0;  // handles with a depth

  bool operator==(const RowCount&) const = default;
};

// RegisteredMesh::Register of so many vertices in one piece; a strip or many pieces cost less.
Cost EstimateRegistration(std::size_t vertices, Basis basis);

// Finds the handles on the mesh, as CompiledHandles::Compile does first, and counts their rows.
// O(#F) and the rows, which are not kept. Faults: those of Compile but for kDuplicateHandle and
// kNumerical.
Result<RowCount> CountRows(const RegisteredMesh& mesh, std::span<const Handle> handles,
                           const CancelToken& cancel = {});
const RowCount& CountRows(const CompiledHandles& handles);

// CompiledHandles::Compile of handles with so many rows.
Cost EstimateCompilation(const RegisteredMesh& mesh, const RowCount& rows);

// CompiledHandles::Edit: `factors` says that mesh and handles are factored together anew, which
// takes about as long as the registration did.
struct EditCost {
  Cost cost;
  bool factors = false;
};
// Ids in `remove` that no handle has count for nothing; `added` is CountRows of those to add.
EditCost EstimateEdit(const CompiledHandles& handles, std::span<const std::string> remove,
                      const RowCount& added);

// Deformer::Update with these options, and FindPicks of so many points.
Cost EstimateFrame(const CompiledHandles& handles, const DeformOptions& options,
                   std::size_t picks = 0);

// What a Deformer with so many lanes holds once it is warm, and has had a crew.
std::size_t DeformerBytes(const CompiledHandles& handles, std::size_t lanes = 1, bool crew = false);

}  // namespace arap
