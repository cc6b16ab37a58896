// Pages in rows and columns over a sheet, and which of them shows what. Millimetres.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/drawing/page.h"

namespace arap {

// Pages in rows and columns, and where the sheet lies under them.
class PageGrid {
 public:
  PageGrid(const Bounds& sheet, double width, double height, double overlap, double margin)
      : width_(width),
        height_(height),
        overlap_(overlap),
        margin_(margin),
        columns_(Count(sheet.width(), window_width())),
        rows_(Count(sheet.height(), window_height())) {
    // The sheet in the middle.
    left_ = (sheet.min_x + sheet.max_x - Covered(columns_, window_width())) / 2;
    top_ = (sheet.min_y + sheet.max_y + Covered(rows_, window_height())) / 2;
  }

  double window_width() const { return width_ - 2 * margin_; }
  double window_height() const { return height_ - 2 * margin_; }
  double columns() const { return columns_; }
  double rows() const { return rows_; }
  double pages() const { return columns_ * rows_; }
  double width() const { return width_; }
  double height() const { return height_; }
  double overlap() const { return overlap_; }
  double margin() const { return margin_; }
  // Row by row, from 1.
  std::size_t NumberOf(std::size_t row, std::size_t column) const {
    return row * static_cast<std::size_t>(columns_) + column + 1;
  }

  // Of the sheet, what a page shows.
  Bounds Window(std::size_t row, std::size_t column) const {
    const double x = left_ + static_cast<double>(column) * StepX();
    const double y = top_ - static_cast<double>(row) * StepY();
    return {x, y - window_height(), x + window_width(), y, false};
  }

  // From the sheet to the page.
  Complex Shift(std::size_t row, std::size_t column) const {
    const Bounds window = Window(row, column);
    return {margin_ - window.min_x, margin_ - window.min_y};
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

  double width_, height_, overlap_, margin_;
  double columns_, rows_;
  double left_ = 0, top_ = 0;
};

// Gives each page of the grid, row by row, the parts of lines that it shows and a millimetre round
// about. False when those would be more than `most`. O(parts) and the rows that each segment is in.
bool Distribute(const std::vector<PageLine>& lines, const PageGrid& grid, std::size_t most,
                std::vector<Page>& pages);

// For each page whether its middle is on one of the triangles; all are where too many large
// triangles lie on each other to find it out.
std::vector<bool> MiddlesOn(std::span<const Triangle> triangles, std::span<const Complex> points,
                            const PageGrid& grid);

}  // namespace arap
