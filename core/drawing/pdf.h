// PDF files of pages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "core/drawing/page.h"

namespace arap {

// The largest side of a page that the format knows, in millimetres.
inline constexpr double kLargestPdfPage = 5080;

// Whether the font of PDF files has all characters of a text: those of Western Europe.
bool PdfShows(std::string_view text);

// One file with all pages in order, at true size; places are exact to 0.0004 mm on the largest
// pages. Text is Helvetica; characters that it has not are question marks. There is no date in it, so
// that the same pages are the same bytes. kInvalidOption for a page that is larger than
// kLargestPdfPage or smaller than 2 mm, kInternal when the library fails.
Result<std::string> FormatPdf(const std::vector<Page>& pages);

}  // namespace arap
