// FlattenSurface: flattening with the memory of what was flattened before.
#pragma once

#include <string>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/flattener.h"
#include "arap/model/mesh.h"
#include "server/flattening/flatten_cache.h"

namespace arap::app {

struct FlatAnswer {
  Flattening flat;
  bool cached = false;  // the prepared surface was there already
};

// Flattens `mesh`, which `limits` bound. With a `surface_key`, the prepared surface of this owner
// is looked up in `cache` and kept there afterwards, also when the flattening itself failed; the
// content of mesh and cuts must be the same, so that a key that is used twice costs time only.
// Faults: those of arap::Flatten, kInvalidName for the key.
Result<FlatAnswer> FlattenSurface(FlattenCache& cache, const std::string& owner,
                                  const std::string& surface_key, SurfaceMesh mesh,
                                  const FlattenOptions& options, const MeshLimits& limits,
                                  const CancelToken& cancel);

}  // namespace arap::app
