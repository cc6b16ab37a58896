// A pattern on pages.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/page_grid.h"
#include "core/drawing/pattern_files.h"
#include "core/drawing/svg.h"

namespace arap {
namespace {

constexpr std::uint32_t kGrey = 0x9a948b;
constexpr std::uint32_t kDark = 0x2b2622;

// Where four pages overlap each of them has a short line; long ones cross more, but are few.
constexpr std::size_t kPagesOfALine = 4, kMostCrossings = 200'000;

Ink InkOf(LineKind kind, bool has_allowance) {
  switch (kind) {
    case LineKind::kOutline:
      return {kDark, 0.3, has_allowance};
    case LineKind::kSeam:
      return {0xc2410c, 0.3, has_allowance};
    case LineKind::kAllowance:
      return {kDark, 0.3, false};
    case LineKind::kGrain:
      return {0x1d4ed8, 0.3, false};
    case LineKind::kNotch:
      return {kDark, 0.3, false};
  }
  return {};
}

// All lines of the pattern as they are drawn, in order.
std::vector<PageLine> DrawnLines(const Pattern& pattern) {
  std::vector<PageLine> drawn;
  for (const PatternPiece& piece : pattern.pieces) {
    const bool has_allowance =
        std::any_of(piece.lines.begin(), piece.lines.end(),
                    [](const PatternLine& line) { return line.kind == LineKind::kAllowance; });
    for (const PatternLine& line : piece.lines) {
      const Ink ink = InkOf(line.kind, has_allowance);
      drawn.push_back({ink, line.closed, line.points});
      if (line.kind != LineKind::kGrain) continue;
      const auto head = ArrowHead(line, 4);
      drawn.push_back({ink, false, {head.begin(), head.end()}});
    }
  }
  return drawn;
}

// A label where it is seen on a page. Helvetica's digits and letters are about half as wide as high.
PageText Text(const PatternLabel& label, Complex shift) {
  constexpr double kWide = 0.28, kRise = 0.36;
  const auto letters = std::count_if(label.text.begin(), label.text.end(), [](char c) {
    return (c & 0xc0) != 0x80;  // each begins with one of these
  });
  const double half = kWide * label.height * static_cast<double>(letters);
  return {label.at + shift - Complex(half, kRise * label.height), label.height, label.text};
}

PageLine Line(Complex a, Complex b, Ink ink) { return {ink, false, {a, b}}; }
PageLine Box(const Bounds& box, Ink ink) {
  return {ink,
          true,
          {{box.min_x, box.min_y},
           {box.max_x, box.min_y},
           {box.max_x, box.max_y},
           {box.min_x, box.max_y}}};
}

std::string SizeText(const Bounds& box) {
  return fmt::format("{:.1f} × {:.1f} mm", box.width(), box.height());
}

// On every page that shows its middle.
void AddLabel(const PatternLabel& label, const PageGrid& grid, std::vector<Page>& pages) {
  const double x = label.at.real(), y = label.at.imag();
  const auto [first_column, last_column] = grid.Columns(x, x);
  const auto [first_row, last_row] = grid.Rows(y, y);
  for (std::size_t row = first_row; row <= last_row; ++row) {
    for (std::size_t column = first_column; column <= last_column; ++column) {
      Page& page = pages[grid.NumberOf(row, column) - 1];
      page.texts.push_back(Text(label, grid.Shift(row, column)));
    }
  }
}

void AddMark(Complex at, std::size_t a, std::size_t b, Page& page) {
  constexpr double kArm = 4, kHeart = 1.5;
  const Ink ink{0, 0.2, false};
  page.lines.push_back(Line(at - kArm, at + kArm, ink));
  page.lines.push_back(Line(at - Complex(0, kArm), at + Complex(0, kArm), ink));
  page.lines.push_back(
      {ink, true, {at + kHeart, at + Complex(0, kHeart), at - kHeart, at - Complex(0, kHeart)}});
  page.texts.push_back({at + Complex(1, 1.5), 2.2, fmt::format("{}/{}", a, b)});
}

// Two marks on each side where another page follows that is not blank, at the same places of the
// sheet on both.
void AddMarks(const PageGrid& grid, const std::vector<bool>& blank, std::size_t row,
              std::size_t column, Page& page) {
  const auto columns = static_cast<std::size_t>(grid.columns());
  const auto rows = static_cast<std::size_t>(grid.rows());
  const std::size_t number = page.number;
  const Bounds& w = page.window;
  const double half = grid.overlap() / 2;
  const auto follows = [&](bool inside, std::size_t other) { return inside && !blank[other - 1]; };
  const bool left = follows(column > 0, number - 1),
             right = follows(column + 1 < columns, number + 1);
  const bool above = follows(row > 0, number - columns);
  const bool below = follows(row + 1 < rows, number + columns);
  for (const double part : {0.25, 0.75}) {
    const double x = w.min_x + part * w.width(), y = w.min_y + part * w.height();
    if (left) AddMark({w.min_x + half, y}, number - 1, number, page);
    if (right) AddMark({w.max_x - half, y}, number, number + 1, page);
    if (above) AddMark({x, w.max_y - half}, number - columns, number, page);
    if (below) AddMark({x, w.min_y + half}, number, number + columns, page);
  }
}

Page EmptyPage(const PageGrid& grid) {
  Page page;
  page.width = grid.width();
  page.height = grid.height();
  const double margin = grid.margin();
  page.window = {margin, margin, grid.width() - margin, grid.height() - margin, false};
  return page;
}

// "12 pages in 3 rows of 4", and which of them are blank.
std::string PagesText(const std::vector<bool>& blank, std::size_t rows, std::size_t columns) {
  const auto none = static_cast<std::size_t>(std::count(blank.begin(), blank.end(), true));
  const std::size_t printed = blank.size() - none;
  std::string text = fmt::format("{} page{} in {} row{} of {}", printed, printed == 1 ? "" : "s",
                                 rows, rows == 1 ? "" : "s", columns);
  if (none > 0) text += ", those that would be blank left out";
  return text + "; print at 100 %, lay marks of one label on each other";
}

Page Cover(const Pattern& pattern, const std::vector<PageLine>& drawn, const PageGrid& grid,
           const std::vector<bool>& blank) {
  constexpr double kSquare = 50, kText = 4, kSmall = 2.6, kSmallLine = 4;
  Page page = EmptyPage(grid);
  const Bounds& w = page.window;
  const auto rows = static_cast<std::size_t>(grid.rows());
  const auto columns = static_cast<std::size_t>(grid.columns());
  double y = w.max_y - kText;
  const auto write = [&](double x, double size, std::string text) {
    page.texts.push_back({{x, y}, size, std::move(text)});
  };
  write(w.min_x, kText, "Sheet of " + SizeText(pattern.Box()));
  y -= kText + 2;
  write(w.min_x, kSmall, PagesText(blank, rows, columns));
  y -= 4;
  const Bounds square{w.min_x, y - kSquare, w.min_x + kSquare, y, false};
  page.lines.push_back(Box(square, {0, 0.2, false}));
  page.texts.push_back(
      {{square.min_x + 4, square.min_y + kSquare / 2 + 2}, kSmall, "50 mm wide and high,"});
  page.texts.push_back(
      {{square.min_x + 4, square.min_y + kSquare / 2 - 2}, kSmall, "or it is printed wrongly"});
  // As many pieces as fit beside the square.
  const double list = square.max_x + 5;
  const std::size_t pieces = pattern.pieces.size();
  const auto fitting = static_cast<std::size_t>(kSquare / kSmallLine);
  const std::size_t listed = pieces > fitting ? fitting - 1 : pieces;
  for (std::size_t i = 0; i < listed; ++i) {
    y -= kSmallLine;
    const PatternPiece& piece = pattern.pieces[i];
    write(list, kSmall,
          fmt::format("piece {}{}{}: {}", i + 1, piece.name.empty() ? "" : " ", piece.name,
                      SizeText(piece.box)));
  }
  if (listed < pieces) {
    y -= kSmallLine;
    write(list, kSmall, fmt::format("and {} more", pieces - listed));
  }

  // The overview, with the pages as they overlap.
  const Bounds first = grid.Window(0, 0), last = grid.Window(rows - 1, columns - 1);
  const double room = square.min_y - 5 - w.min_y;
  const double scale =
      std::min(w.width() / (last.max_x - first.min_x), room / (first.max_y - last.min_y));
  const auto at = [&](Complex p) {
    return Complex(w.min_x + scale * (p.real() - first.min_x),
                   square.min_y - 5 - scale * (first.max_y - p.imag()));
  };
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const Bounds window = grid.Window(row, column);
      const Complex low = at({window.min_x, window.min_y}), high = at({window.max_x, window.max_y});
      const std::size_t number = grid.NumberOf(row, column);
      page.lines.push_back(Box({low.real(), low.imag(), high.real(), high.imag(), false},
                               {kGrey, 0.15, /*dashed=*/blank[number - 1]}));
      if (blank[number - 1]) continue;
      // In the corner that no other page covers.
      const double size = std::min(5.0, 0.2 * (high.imag() - low.imag()));
      const double inset = scale * grid.overlap() + 1;
      page.texts.push_back(
          {{low.real() + inset, high.imag() - inset - 0.75 * size}, size, fmt::to_string(number)});
    }
  }
  constexpr double kVisible = 0.1;
  for (const PageLine& line : drawn) {
    PageLine small{{line.ink.rgb, 0.2, false}, line.closed, {}};
    for (const Complex p : line.points) {
      const Complex place = at(p);
      if (small.points.empty() || &p == &line.points.back() ||
          std::abs(place - small.points.back()) > kVisible) {
        small.points.push_back(place);
      }
    }
    page.drawing.push_back(std::move(small));
  }
  return page;
}

double RangeOf(const Pattern& pattern) {
  return StrainRange(LargestStrainPercent(pattern.singular_values));
}

std::uint32_t RgbOf(int shade) {
  return static_cast<std::uint32_t>(std::stoul(StrainColor(shade).substr(1), nullptr, 16));
}

void AddStrain(const Pattern& pattern, Complex shift, Page& page) {
  for (const auto& [shade, lines] :
       TrianglesByShade(pattern.triangles, pattern.singular_values, RangeOf(pattern))) {
    PageArea& area = page.areas.emplace_back(PageArea{RgbOf(shade), {}});
    for (const auto& line : lines) {
      area.triangles.push_back({pattern.points[line[0]] + shift, pattern.points[line[1]] + shift,
                                pattern.points[line[2]] + shift});
    }
  }
}

// The colours from −range to +range percent at the lower left of the page, and the caption under
// them. Answers how high they are together, and makes the page wide enough.
double AddLegend(const Pattern& pattern, const std::vector<std::string>& caption, Page& page) {
  // Letters grow with large sheets, so that an overview still shows them.
  const double scale = std::max(1.0, std::max(page.width, page.height) / 300);
  const double size = 3.4 * scale, width = 80 * scale, left = kPageMargin;
  page.width = std::max(page.width, 2 * left + 150 * scale);
  double y = kPageMargin;
  for (auto line = caption.rbegin(); line != caption.rend(); ++line, y += 5 * scale) {
    page.texts.push_back({{left, y}, size, *line});
  }
  y += 2 * scale;
  const double range = RangeOf(pattern);
  page.texts.push_back({{left, y}, size, fmt::format("-{:g} %", range)});
  page.texts.push_back({{left + width / 2 - scale, y}, size, "0"});
  page.texts.push_back({{left + width - 9 * scale, y}, size, fmt::format("+{:g} %", range)});
  y += 4 * scale;
  const double step = width / (2 * kStrainShades + 1), high = y + 4 * scale;
  for (int shade = -kStrainShades; shade <= kStrainShades; ++shade) {
    const double x = left + (shade + kStrainShades) * step, end = x + step;
    page.areas.push_back({RgbOf(shade),
                          {{Complex(x, y), Complex(end, y), Complex(end, high)},
                           {Complex(x, y), Complex(end, high), Complex(x, high)}}});
  }
  page.texts.push_back({{left, high + 1.5 * scale}, size, "larger principal strain"});
  // A length to check a print by.
  const double length = scale < 2 ? 50 : 100, from = left + width + 10 * scale;
  page.lines.push_back({{kDark, 0.3, false},
                        false,
                        {{from, high}, {from, y}, {from + length, y}, {from + length, high}}});
  page.texts.push_back({{from, y - 4 * scale}, size, fmt::format("{} mm", length)});
  return high + 2 * size;
}

}  // namespace

Status CheckPages(const Paper& paper, double overlap, double margin) {
  if (!(margin >= 0 && margin <= kMaxPageMargin)) {
    return Fail(
        Fault(FaultKind::kInvalidOption,
              fmt::format("The margin is {} mm; it must be 0 to {}.", margin, kMaxPageMargin))
            .Field("margin"));
  }
  const double most = (std::min(paper.width, paper.height) - 2 * margin) / 2;
  if (!(overlap >= 0 && overlap <= most)) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("The overlap is {} mm; it must be 0 to {}.", overlap, most))
                    .Field("overlap"));
  }
  return {};
}

Result<std::vector<Page>> TilePages(const Pattern& pattern, const Paper& paper, double overlap,
                                    double margin) {
  CHECK_OK(CheckPages(paper, overlap, margin));
  const Bounds sheet = pattern.Box();
  PageGrid grid(sheet, paper.width, paper.height, overlap, margin);
  if (const PageGrid turned(sheet, paper.height, paper.width, overlap, margin);
      paper.either_way && turned.pages() < grid.pages()) {
    grid = turned;
  }
  if (!(grid.pages() <= kMostPages)) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("The sheet of {} would take {:.0f} pages; at most {} are drawn. "
                                  "Larger paper helps, or another unit.",
                                  SizeText(sheet), grid.pages(), kMostPages))
                    .Field("paper"));
  }
  const auto rows = static_cast<std::size_t>(grid.rows());
  const auto columns = static_cast<std::size_t>(grid.columns());
  std::vector<Page> pages(rows * columns, EmptyPage(grid));
  const std::vector<PageLine> drawn = DrawnLines(pattern);
  std::size_t most = kMostCrossings;
  for (const PageLine& line : drawn) most += kPagesOfALine * line.points.size();
  if (!Distribute(drawn, grid, most, pages)) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("On {} pages the lines would have more than {} parts. Larger "
                                  "paper helps, or another unit.",
                                  pages.size(), most))
                    .Field("paper"));
  }
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLabel& label : piece.labels) AddLabel(label, grid, pages);
  }
  std::vector<bool> blank;
  const std::vector<bool> inside = MiddlesOn(pattern.triangles, pattern.points, grid);
  for (std::size_t i = 0; i < pages.size(); ++i) {
    // Without lines it is inside of a piece or outside of all, as a whole.
    blank.push_back(pages[i].drawing.empty() && pages[i].texts.empty() && !inside[i]);
  }
  std::vector<Page> printed{Cover(pattern, drawn, grid, blank)};
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t number = grid.NumberOf(row, column);
      if (blank[number - 1]) continue;
      Page& page = pages[number - 1];
      page.number = number;
      page.lines.push_back(Box(page.window, {kGrey, 0.15, false}));
      AddMarks(grid, blank, row, column, page);
      // Below the frame where there is room, else above its lower line.
      constexpr double kLetters = 3, kRoom = 8;
      const double y = margin >= kRoom ? margin / 2 : margin + kLetters / 2;
      page.texts.push_back({{margin + (margin >= kRoom ? 0 : kLetters / 2), y},
                            kLetters,
                            fmt::format("page {} of {}: row {}, column {}", number, pages.size(),
                                        row + 1, column + 1)});
      printed.push_back(std::move(page));
    }
  }
  return printed;
}

Page SheetPage(const Pattern& pattern, const PatternSheet& sheet) {
  const Bounds box = pattern.Box();
  Page page;
  page.width = box.width() + 2 * kPageMargin;
  page.height = box.height() + 2 * kPageMargin;
  const double below = sheet.strain ? AddLegend(pattern, sheet.caption, page) : 0;
  page.height += below;
  page.window = {0, 0, page.width, page.height, false};
  const Complex shift(kPageMargin - box.min_x, below + kPageMargin - box.min_y);
  if (sheet.strain) AddStrain(pattern, shift, page);
  if (sheet.interior) {
    for (const auto& line : InnerLines(pattern.triangles)) {
      PageLine& drawn = page.drawing.emplace_back(PageLine{{kGrey, 0.1, false}, false, {}});
      for (const std::uint32_t u : line) drawn.points.push_back(pattern.points[u]);
    }
  }
  for (PageLine& line : DrawnLines(pattern)) page.drawing.push_back(std::move(line));
  for (PageLine& line : page.drawing) {
    for (Complex& p : line.points) p += shift;
  }
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLabel& label : piece.labels) {
      if (sheet.strain || !label.is_name) page.texts.push_back(Text(label, shift));
    }
  }
  return page;
}

}  // namespace arap
