// What becomes of a pattern: an SVG at true size (pattern_sheet.cc), DXF for cutters and CAD (dxf.cc),
// and pages of paper that are joined to give the sheet (tiling.cc).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "core/drawing/page.h"
#include "core/drawing/pattern.h"

namespace arap {

struct PatternSheet {
  // Colour the triangles by strain, with a ground, a legend and the caption. Without it there is
  // nothing besides the lines, and no names.
  bool strain = true;
  bool interior = false;  // draw the edges inside
  std::vector<std::string> caption;
};

// Width, height and view box are in millimetres, so that it prints at true size. Groups by id:
// strain, interior, outline, seam, grain, allowance, notch, label; each only when there is something in it.
// Places are rounded to DigitsFor the pattern, 0.001 mm unless it is small (those of strain and
// interior to a digit less).
std::string FormatPattern(const Pattern& pattern, const PatternSheet& sheet);

// DXF of release 2000 (ASCII), the first that says its unit: millimetres ($INSUNITS 4,
// $MEASUREMENT 1), y up. Layers: OUTLINE and SEAM with polylines, closed where they are, CUT (the
// allowance) with closed ones, GRAIN and NOTCH with lines, LABEL with texts. Three digits more than
// DigitsFor the pattern.
std::string FormatDxf(const Pattern& pattern);

// Whether the format has all characters of a text: those of the basic plane of Unicode. Others are
// question marks.
bool DxfShows(std::string_view text);

// What no printer reaches, on each side of a page, unless it is told otherwise.
inline constexpr double kPageMargin = 10;
inline constexpr std::size_t kMostPages = 1000;

// kInvalidOption with the field "overlap" or "margin" unless pages of this paper can share so much
// and have such margins: at most half of what is left between the margins.
Status CheckPages(const Paper& paper, double overlap, double margin);

// A cover with an overview, the sizes of the pieces and a square of 50 mm to check the print by;
// then the pages row by row from the top left, each with its number, a frame where it ends, and marks
// in the middle of the `overlap` that it shares with its neighbours. A mark is labelled with the
// numbers of both pages; laid on its twin it puts them together. Whatever is near the frame is on
// both. Pages that would show nothing and are not inside of a piece are left out; the others keep
// their numbers, and the cover shows which they are. Lines only, without colours of strain.
// kInvalidOption when it would take more than kMostPages, when more lines than four for each of the
// pattern and 200 000 cross from page to page, and as CheckPages.
Result<std::vector<Page>> TilePages(const Pattern& pattern, const Paper& paper, double overlap,
                                    double margin = kPageMargin);

// The whole sheet on one page of its size. With colours of strain they are explained below, with the
// caption under them.
Page SheetPage(const Pattern& pattern, const PatternSheet& sheet = {false, false, {}});

}  // namespace arap
