// Placing handles: from what the client says to constraint rows on the mesh [algorithm §2].
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/cost.h"
#include "arap/model/handle.h"
#include "core/deform/registered_parts.h"

namespace arap {

// One constraint: Σ weight[k] · v[vertex[k]] should be at a target, with a compliance of 1/weight.
struct Row {
  std::uint32_t handle = 0;  // index in the set
  std::array<std::uint32_t, 3> vertex{};
  std::array<double, 3> weight{};
  Complex rest;           // of the constrained point, normalised
  Complex offset;         // from the handle's rest position to that point, normalised
  double compliance = 0;  // 0: hard
  std::uint32_t component = 0;

  // The only vertex that counts, with weight 1, or kNone: the row of a vertex that an area or
  // oriented handle holds, or of a handle on a vertex.
  std::uint32_t single_vertex() const {
    std::uint32_t single = kNone;
    for (std::size_t k = 0; k < 3; ++k) {
      if (weight[k] == 0) continue;
      if (single != kNone) return kNone;
      single = vertex[k];
    }
    return single;
  }
};

struct Placement {
  PlacedHandle placed;
  std::vector<Row> rows;  // at least one; Row::handle is left 0
};

// Finds the handles on the mesh, in their order. The first that is not acceptable is the fault,
// with the field "array[i]…" and its number: kInvalidOption, kIndexOutOfRange, kHandleOutside
// (detail "distance"; a point within 1e-6 of the diagonal outside counts as on the border); kTooManyHandles when they have, with `kept` other rows, more than MostRows of
// the mesh; that of `cancel`, asked handle by handle. O(#F) for all together, and O(#E) for
// every one that is snapped.
Result<std::vector<Placement>> PlaceHandles(const RegisteredMeshParts& mesh,
                                            std::span<const Handle> handles, std::string_view array,
                                            std::size_t kept, const CancelToken& cancel);

// Counts a row under what it costs.
void CountRow(const Row& row, RowCount& count);

}  // namespace arap
