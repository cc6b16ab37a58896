// Stores whose every operation is timed and counted in the metrics.
#pragma once

#include "server/runtime/metrics.h"
#include "server/store/open_store.h"

namespace arap::store {

// The same stores; `metrics` outlives them. Operations are called "load", "put", "blob_put", ….
Stores Measured(Stores stores, runtime::Metrics& metrics);

}  // namespace arap::store
