// Placing handles: from what the client says to constraint rows on the mesh [algorithm §2].
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/result.h"
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
};

struct Placement {
  PlacedHandle placed;
  std::vector<Row> rows;  // at least one; Row::handle is left 0
};

// Finds the handles on the mesh, in their order. The first that is not acceptable is the fault,
// with the field "handles[i]…" and its number: kInvalidOption, kIndexOutOfRange, kHandleOutside
// (detail "distance"). O(#F) for those on vertices together and for every other one.
Result<std::vector<Placement>> PlaceHandles(const RegisteredMeshParts& mesh,
                                            std::span<const Handle> handles);

}  // namespace arap
