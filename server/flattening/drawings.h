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
#include "server/runtime/metrics.h"

namespace arap::app {

// What is to be drawn. Options and parts are good (CheckDrawing, CheckParts).
struct DrawingOrder {
  std::span<const DrawingOptions> drawings;
  std::span<const NamedPart> parts;
  std::span<const GrainLine> grain_lines;  // that the layout was made with
  std::size_t most_bytes = 0;              // of all files together; 0: any number
};

struct Drawn {
  std::vector<Drawing> drawings;                 // one for each that was asked for
  std::vector<DerivedCache::Reservation> rooms;  // of their files
};

// Reserves memory for each drawing before it is begun and keeps what its files take. `progress` is
// told of "drawing", `metrics` how long it took. For the job lane. Faults: those of arap::Draw with
// the field "drawings[i]…", kLimitExceeded when the memory is not to be had or the files are more
// than the most bytes, which ends the work.
Result<Drawn> DrawAll(DerivedCache& derived, runtime::Metrics& metrics, const Caller& caller,
                      const DrawingOrder& order, const Flattening& flat, const CancelToken& cancel,
                      const FlattenProgress& progress);

}  // namespace arap::app
