// The drawings of flatten: which files, and what is in them.
#pragma once

#include <string>
#include <vector>

#include "arap/base/result.h"
#include "client/cli/commands/flatten_flags.h"
#include "core/drawing/pattern.h"
#include "core/files/surface_file.h"

namespace arap::cli {

// What can be said before there is a layout: kInvalidOption for options that do not go together.
Status CheckDrawings(const DrawingFlags& flags);

// What the file calls its parts: by object where it has several, else by group, else by its one
// object. Empty where nothing has a name.
std::vector<NamedPart> PartsOf(const SurfaceFile& file);

// Warnings of names that the files which are asked for cannot show.
std::vector<Warning> NameWarningsOf(const DrawingFlags& flags, const Pattern& pattern);

// Writes what --svg, --dxf and --pdf ask for. With --paper an SVG is a file per page: "a.svg" is
// a-cover.svg, a-1.svg, a-2.svg, … `caption` goes under the colours. kInvalidOption for what paper
// or PDF cannot hold; kInternal with the path when a file cannot be written.
Status WriteDrawings(const DrawingFlags& flags, const Pattern& pattern,
                     const std::vector<std::string>& caption);

}  // namespace arap::cli
