// What is measured of the process and of an engine at the moment of reading.
#pragma once

#include "server/runtime/metrics.h"

namespace arap::app {
struct Engine;
}

namespace arap::host {

// Memory, descriptors, processor time and start of this process, under the names that Prometheus
// gives them everywhere (process_…), and arapd_build_info.
void WatchProcess(runtime::Metrics& metrics);

// Lanes, streams, and what the caches hold. `engine` owns the metrics.
void WatchEngine(app::Engine& engine);

}  // namespace arap::host
