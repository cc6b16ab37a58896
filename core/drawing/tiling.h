// A pattern on pages of paper that are joined to give the sheet.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/base/result.h"
#include "core/drawing/page.h"
#include "core/drawing/paper.h"
#include "core/drawing/pattern.h"

namespace arap {

// What no printer reaches, on each side of a page.
inline constexpr double kPageMargin = 10;
inline constexpr std::size_t kMostPages = 1000;

// A cover with an overview, the sizes of the pieces and a square of 50 mm to check the print by;
// then the pages row by row from the top left, each with its number, a frame where it ends, and marks
// in the middle of the `overlap` that it shares with its neighbours. A mark is labelled with the
// numbers of both pages; laid on its twin it puts them together. Whatever is near the frame is on
// both. Lines only, without colours of strain. kInvalidOption when it would take more than
// kMostPages or when `overlap` is more than half of a page.
Result<std::vector<Page>> TilePages(const Pattern& pattern, const Paper& paper, double overlap);

// The whole sheet on one page of its size.
Page SheetPage(const Pattern& pattern);

}  // namespace arap
