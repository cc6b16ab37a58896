// The options of the server under the names that the command line uses.
#pragma once

#include <CLI/CLI.hpp>

#include "arap/client/energy.h"
#include "arap/client/shape.h"

namespace arap::cli {

// --basis and --weights. `planar`: with the vertex basis; a surface has none.
void AddEnergyOptions(CLI::App& command, client::EnergyOptions& energy, bool planar);

// --mode and --refine.
void AddDeformOptions(CLI::App& command, client::DeformOptions& options);

}  // namespace arap::cli
