// Drawings of a layout, in memory that belongs to its owner.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/flattener.h"
#include "arap/model/drawing.h"
#include "server/access/caller.h"
#include "server/budget/derived_cache.h"

namespace arap::app {

// What is to be drawn. Options and parts are good (CheckDrawing, CheckParts).
struct DrawingOrder {
  std::span<const DrawingOptions> drawings;
  std::span<const NamedPart> parts;
  std::span<const GrainLine> grain_lines;  // that the layout was made with
};

struct Drawn {
  std::vector<Drawing> drawings;                 // one for each that was asked for
  std::vector<DerivedCache::Reservation> rooms;  // of their files
};

// Reserves memory for each drawing before it is begun and keeps what its files take. `progress` is
// told of "drawing". For the job lane. Faults: those of arap::Draw with the field "drawings[i]…",
// kLimitExceeded when the memory is not to be had or the files are more than `most` bytes together
// (0: any number), which ends the work.
Result<Drawn> DrawAll(DerivedCache& derived, const Caller& caller, const DrawingOrder& order,
                      const Flattening& flat, std::size_t most, const CancelToken& cancel,
                      const FlattenProgress& progress);

}  // namespace arap::app
