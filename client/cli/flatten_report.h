// What flatten says about its result.
#pragma once

#include <string>
#include <vector>

#include "arap/client/flatten.h"

namespace arap::cli {

// A JSON object: counts, every measure of distortion, anchors, warnings and times.
std::string JsonReport(const client::SurfaceMesh& mesh, const client::FlatSurface& flat);
// The same in a few lines for people.
std::vector<std::string> Summary(const client::SurfaceMesh& mesh, const client::FlatSurface& flat);

}  // namespace arap::cli
