// From a layout to the bytes of its drawings, for the command line and for the server.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"
#include "core/drawing/pattern.h"

namespace arap {

// What can be said of the options without a layout. kInvalidOption with the field as DrawingOptions
// has it.
Status CheckDrawing(const DrawingOptions& options);

// The pattern that good options ask for. `names` are those of the pieces, or none; `grain_lines`
// those that the layout was made with. Faults: those of MakePattern; kInvalidOption
// ("millimetres_per_unit") when places would be more than 10^12 mm from 0.
Result<Pattern> PatternFor(const DrawingOptions& options, const Flattening& flat,
                           std::span<const GrainLine> grain_lines,
                           std::span<const std::string> names, const CancelToken& cancel = {});

// The files of a pattern that was made for these options. `caption` goes under the colours of an
// SVG. Faults: kInvalidOption ("paper") for what pages cannot hold, and that of `cancel`, which is
// asked between the steps.
Result<std::vector<DrawingFile>> FilesOf(const Pattern& pattern, const DrawingOptions& options,
                                         const std::vector<std::string>& caption,
                                         const CancelToken& cancel = {});

// Both, with the summary as the caption, and warnings: those of the pattern, "unlikely_size"
// (SizeWarnings), and "unknown_characters" for names that the format cannot show.
Result<Drawing> Draw(const DrawingOptions& options, const Flattening& flat,
                     std::span<const GrainLine> grain_lines, std::span<const std::string> names,
                     const CancelToken& cancel = {});

// "unknown_characters" where names of pieces have characters that the format cannot show.
std::vector<Warning> NameWarnings(const Pattern& pattern, DrawingFormat format);

// What a drawing takes, before it is begun. At most twice what was measured of winding outlines of
// 40 000 points; an allowance that is wide beside the bends of its outline may take less.
struct DrawingCost {
  double milliseconds = 0;
  std::size_t bytes = 0;  // at the peak, with its files
};
// `border`: flat positions on the outlines of all pieces.
DrawingCost EstimateDrawing(const DrawingOptions& options, std::size_t triangles,
                            std::size_t border);
// Bytes that its files have for certain.
std::size_t LeastDrawingBytes(const DrawingOptions& options, std::size_t triangles);

}  // namespace arap
