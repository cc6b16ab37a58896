// A pattern on pages of paper that are joined to give the sheet.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/base/result.h"
#include "core/drawing/page.h"
#include "core/drawing/paper.h"
#include "core/drawing/pattern.h"
#include "core/drawing/pattern_sheet.h"

namespace arap {

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
// their numbers, and the cover shows which they are. Lines only, without colours of strain. kInvalidOption when it would take more than
// kMostPages, when more lines than four for each of the pattern and 200 000 cross from page to page, and as CheckPages.
Result<std::vector<Page>> TilePages(const Pattern& pattern, const Paper& paper, double overlap,
                                    double margin = kPageMargin);

// The whole sheet on one page of its size. With colours of strain they are explained below, with the
// caption under them.
Page SheetPage(const Pattern& pattern, const PatternSheet& sheet = {false, false, {}});

}  // namespace arap
