// The flags of arapd.
#pragma once

#include <CLI/CLI.hpp>

#include "server/config/config.h"

namespace arap::config {

// `config` outlives `app`; its values are the defaults.
void AddFlags(CLI::App& app, Config& config);

}  // namespace arap::config
