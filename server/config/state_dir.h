// Where arapd keeps sessions unless told otherwise.
#pragma once

#include <string>
#include <vector>

#include "arap/base/result.h"

namespace arap::config {

// The first that is there of $STATE_DIRECTORY (as systemd gives it), $XDG_STATE_HOME/arapd and
// $HOME/.local/state/arapd; else /var/lib/arapd. `environment` has "NAME=value" entries.
std::string StateDirectory(const std::vector<std::string>& environment);

// Makes the parents of the directory of "sqlite:DIR"; nothing for other stores. kStoreUnavailable.
Status MakeParents(const std::string& store);

}  // namespace arap::config
