// Check: what can be found wrong with a config without serving.
#pragma once

#include "arap/base/result.h"
#include "server/config/config.h"

namespace arap::config {

// Whatever can be found wrong without serving: addresses, files, folders, numbers that contradict
// each other. Nothing is created, bound or connected. Faults name the flag in `field`.
Status Check(const Config& config);

}  // namespace arap::config
