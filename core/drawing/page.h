// Pages to print: what is on them, and as an SVG.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/drawing/outline.h"

namespace arap {

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

}  // namespace arap
