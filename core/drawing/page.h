// Pages to print: the sizes of paper, what is on a page, and pages as SVG and PDF files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "core/base/plane.h"

namespace arap {

struct Paper {
  double width = 0, height = 0;  // millimetres
  bool either_way = false;       // may be turned on its side
};

// "A4" (A0 to A5), "letter", "legal", "tabloid", or "WIDTHxHEIGHT" in millimetres, which is not
// turned. kInvalidOption for anything else and for sides that are not 100 to 5080 mm.
Result<Paper> ParsePaper(std::string_view text);

// How a line is drawn.
struct Ink {
  std::uint32_t rgb = 0;  // 0xrrggbb
  double width = 0.3;     // millimetres
  bool dashed = false;
};

struct PageLine {
  Ink ink;
  bool closed = false;
  std::vector<Complex> points;
};

// Triangles of one colour.
struct PageArea {
  std::uint32_t rgb = 0;
  std::vector<std::array<Complex, 3>> triangles;
};

// One line of text; `at` is the left end of its base line.
struct PageText {
  Complex at;
  double size = 3;  // millimetres
  std::string text;
};

// Millimetres from the lower left corner, y up.
struct Page {
  std::size_t number = 0;  // among those of a sheet, 0: its cover or all of it
  double width = 0, height = 0;
  Bounds window;                  // what `areas` and `drawing` show through
  std::vector<PageArea> areas;    // below everything else
  std::vector<PageLine> drawing;  // at true size
  std::vector<PageLine> lines;    // frame, marks and the like
  std::vector<PageText> texts;
};

// With width, height and view box in millimetres, and so many digits after the point.
std::string FormatPageSvg(const Page& page, int digits);

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
