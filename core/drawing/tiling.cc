#include "core/drawing/tiling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/pdf.h"

namespace arap {
namespace {

constexpr std::uint32_t kGrey = 0x9a948b;
constexpr std::uint32_t kDark = 0x2b2622;

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
  const double half = kWide * label.height * static_cast<double>(label.text.size());
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

// Pages in rows and columns, and where the sheet lies under them.
class Grid {
 public:
  Grid(const Bounds& sheet, double width, double height, double overlap)
      : width_(width),
        height_(height),
        overlap_(overlap),
        columns_(Count(sheet.width(), window_width())),
        rows_(Count(sheet.height(), window_height())) {
    // The sheet in the middle.
    left_ = (sheet.min_x + sheet.max_x - Covered(columns_, window_width())) / 2;
    top_ = (sheet.min_y + sheet.max_y + Covered(rows_, window_height())) / 2;
  }

  double window_width() const { return width_ - 2 * kPageMargin; }
  double window_height() const { return height_ - 2 * kPageMargin; }
  double columns() const { return columns_; }
  double rows() const { return rows_; }
  double pages() const { return columns_ * rows_; }
  double width() const { return width_; }
  double height() const { return height_; }
  double overlap() const { return overlap_; }

  // Of the sheet, what a page shows.
  Bounds Window(std::size_t row, std::size_t column) const {
    const double x = left_ + static_cast<double>(column) * StepX();
    const double y = top_ - static_cast<double>(row) * StepY();
    return {x, y - window_height(), x + window_width(), y, false};
  }

  // The columns (first, last) that show any of x from `low` to `high`.
  std::pair<std::size_t, std::size_t> Columns(double low, double high) const {
    return Range((low - left_ - window_width()) / StepX(), (high - left_) / StepX(), columns_);
  }
  std::pair<std::size_t, std::size_t> Rows(double low, double high) const {
    return Range((top_ - high - window_height()) / StepY(), (top_ - low) / StepY(), rows_);
  }

 private:
  // One more millimetre on each side: a line at the edge has a width.
  double Count(double size, double window) const {
    return std::max(1.0, std::ceil((size + 2 - overlap_) / (window - overlap_)));
  }
  double Covered(double count, double window) const {
    return count * (window - overlap_) + overlap_;
  }
  double StepX() const { return window_width() - overlap_; }
  double StepY() const { return window_height() - overlap_; }
  static std::pair<std::size_t, std::size_t> Range(double after, double until, double count) {
    const double first = std::clamp(std::ceil(after), 0.0, count - 1);
    const double last = std::clamp(std::floor(until), 0.0, count - 1);
    return {static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
  }

  double width_, height_, overlap_;
  double columns_, rows_;
  double left_ = 0, top_ = 0;
};

// Gives each page the parts of lines that it shows.
class Distributor {
 public:
  Distributor(const Grid& grid, std::vector<Page>& pages)
      : grid_(grid), pages_(pages), ends_(pages.size()) {}

  void Add(const PageLine& line) {
    ++line_;
    const std::size_t n = line.points.size(), segments = line.closed ? n : n - 1;
    for (std::size_t i = 0; i < segments; ++i) {
      const Complex a = line.points[i], b = line.points[(i + 1) % n];
      Bounds box;
      box.Add(a);
      box.Add(b);
      const auto [first_column, last_column] = grid_.Columns(box.min_x, box.max_x);
      const auto [first_row, last_row] = grid_.Rows(box.min_y, box.max_y);
      for (std::size_t row = first_row; row <= last_row; ++row) {
        for (std::size_t column = first_column; column <= last_column; ++column) {
          AddSegment(line, a, b, i, row, column);
        }
      }
    }
  }

  // On every page that shows its middle.
  void Add(const PatternLabel& label) {
    const double x = label.at.real(), y = label.at.imag();
    const auto [first_column, last_column] = grid_.Columns(x, x);
    const auto [first_row, last_row] = grid_.Rows(y, y);
    for (std::size_t row = first_row; row <= last_row; ++row) {
      for (std::size_t column = first_column; column <= last_column; ++column) {
        pages_[At(row, column)].texts.push_back(Text(label, Shift(row, column)));
      }
    }
  }

 private:
  struct End {
    std::size_t line = 0, segment = 0;
  };

  std::size_t At(std::size_t row, std::size_t column) const {
    return row * static_cast<std::size_t>(grid_.columns()) + column;
  }
  // From the sheet to the page.
  Complex Shift(std::size_t row, std::size_t column) const {
    const Bounds window = grid_.Window(row, column);
    return {kPageMargin - window.min_x, kPageMargin - window.min_y};
  }

  void AddSegment(const PageLine& line, Complex a, Complex b, std::size_t segment, std::size_t row,
                  std::size_t column) {
    const std::size_t at = At(row, column);
    const Complex shift = Shift(row, column);
    std::vector<PageLine>& drawing = pages_[at].drawing;
    if (ends_[at].line != line_ || ends_[at].segment != segment) {
      drawing.push_back({line.ink, false, {a + shift}});
    }
    PageLine& part = drawing.back();
    // All of a closed line is closed here too.
    if (line.closed && part.points.size() == line.points.size()) {
      part.closed = true;
    } else {
      part.points.push_back(b + shift);
    }
    ends_[at] = {line_, segment + 1};
  }

  const Grid& grid_;
  std::vector<Page>& pages_;
  std::vector<End> ends_;  // of each page, what was drawn last on it
  std::size_t line_ = 0;
};

void AddMark(Complex at, std::size_t a, std::size_t b, Page& page) {
  constexpr double kArm = 4, kHeart = 1.5;
  const Ink ink{0, 0.2, false};
  page.lines.push_back(Line(at - kArm, at + kArm, ink));
  page.lines.push_back(Line(at - Complex(0, kArm), at + Complex(0, kArm), ink));
  page.lines.push_back(
      {ink, true, {at + kHeart, at + Complex(0, kHeart), at - kHeart, at - Complex(0, kHeart)}});
  page.texts.push_back({at + Complex(1, 1.5), 2.2, fmt::format("{}/{}", a, b)});
}

// Two marks on each side where another page follows, at the same places of the sheet on both.
void AddMarks(const Grid& grid, std::size_t row, std::size_t column, Page& page) {
  const auto columns = static_cast<std::size_t>(grid.columns());
  const auto rows = static_cast<std::size_t>(grid.rows());
  const std::size_t number = row * columns + column + 1;
  const Bounds& w = page.window;
  const double half = grid.overlap() / 2;
  for (const double part : {0.25, 0.75}) {
    const double x = w.min_x + part * w.width(), y = w.min_y + part * w.height();
    if (column > 0) AddMark({w.min_x + half, y}, number - 1, number, page);
    if (column + 1 < columns) AddMark({w.max_x - half, y}, number, number + 1, page);
    if (row > 0) AddMark({x, w.max_y - half}, number - columns, number, page);
    if (row + 1 < rows) AddMark({x, w.min_y + half}, number, number + columns, page);
  }
}

Page EmptyPage(const Grid& grid) {
  Page page;
  page.width = grid.width();
  page.height = grid.height();
  page.window = {kPageMargin, kPageMargin, grid.width() - kPageMargin, grid.height() - kPageMargin,
                 false};
  return page;
}

Page Cover(const Pattern& pattern, const std::vector<PageLine>& drawn, const Grid& grid) {
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
  write(w.min_x, kSmall,
        fmt::format("{} page{} in {} row{} of {}; print at 100 %, lay marks of one label on each "
                    "other",
                    rows * columns, rows * columns == 1 ? "" : "s", rows, rows == 1 ? "" : "s",
                    columns));
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
      page.lines.push_back(
          Box({low.real(), low.imag(), high.real(), high.imag(), false}, {kGrey, 0.15, false}));
      // In the corner that no other page covers.
      const double size = std::min(5.0, 0.2 * (high.imag() - low.imag()));
      const double inset = scale * grid.overlap() + 1;
      page.texts.push_back({{low.real() + inset, high.imag() - inset - 0.75 * size},
                            size,
                            fmt::to_string(row * columns + column + 1)});
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

}  // namespace

Result<std::vector<Page>> TilePages(const Pattern& pattern, const Paper& paper, double overlap) {
  const double shorter = std::min(paper.width, paper.height) - 2 * kPageMargin;
  if (!(overlap >= 0 && overlap <= shorter / 2)) {
    return Fail(
        Fault(FaultKind::kInvalidOption,
              fmt::format("The overlap is {} mm; it must be 0 to {}.", overlap, shorter / 2))
            .Field("overlap"));
  }
  const Bounds sheet = pattern.Box();
  Grid grid(sheet, paper.width, paper.height, overlap);
  if (const Grid turned(sheet, paper.height, paper.width, overlap);
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
  Distributor distributor(grid, pages);
  for (const PageLine& line : drawn) distributor.Add(line);
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLabel& label : piece.labels) distributor.Add(label);
  }
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t number = row * columns + column + 1;
      Page& page = pages[number - 1];
      page.lines.push_back(Box(page.window, {kGrey, 0.15, false}));
      AddMarks(grid, row, column, page);
      page.texts.push_back({{kPageMargin, 5},
                            3,
                            fmt::format("page {} of {}: row {}, column {}", number, pages.size(),
                                        row + 1, column + 1)});
    }
  }
  pages.insert(pages.begin(), Cover(pattern, drawn, grid));
  return pages;
}

Page SheetPage(const Pattern& pattern) {
  const Bounds sheet = pattern.Box();
  Page page;
  page.width = sheet.width() + 2 * kPageMargin;
  page.height = sheet.height() + 2 * kPageMargin;
  page.window = {0, 0, page.width, page.height, false};
  const Complex shift(kPageMargin - sheet.min_x, kPageMargin - sheet.min_y);
  page.drawing = DrawnLines(pattern);
  for (PageLine& line : page.drawing) {
    for (Complex& p : line.points) p += shift;
  }
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLabel& label : piece.labels) page.texts.push_back(Text(label, shift));
  }
  return page;
}

}  // namespace arap
