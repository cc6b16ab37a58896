#include "core/drawing/page_grid.h"

#include <optional>

namespace arap {
namespace {

// The part of a segment that is in a box, if any. An end that is inside stays as it is.
std::optional<std::pair<Complex, Complex>> Clipped(Complex a, Complex b, const Bounds& box) {
  const Complex along = b - a;
  double from = 0, to = 1;
  // Where it is on the inner side of each side of the box: room + t·rate >= 0.
  const auto keep = [&](double room, double rate) {
    if (rate == 0) return room >= 0;
    const double at = -room / rate;
    if (rate > 0) from = std::max(from, at);
    if (rate < 0) to = std::min(to, at);
    return from <= to;
  };
  if (!keep(a.real() - box.min_x, along.real()) || !keep(box.max_x - a.real(), -along.real()) ||
      !keep(a.imag() - box.min_y, along.imag()) || !keep(box.max_y - a.imag(), -along.imag())) {
    return std::nullopt;
  }
  return std::pair(from > 0 ? a + from * along : a, to < 1 ? a + to * along : b);
}

// Gives each page the parts of lines that it shows.
class Distributor {
 public:
  // At most `most` parts of lines.
  Distributor(const PageGrid& grid, std::size_t most, std::vector<Page>& pages)
      : grid_(grid), left_(most), pages_(pages), ends_(pages.size()) {}

  // False when there are too many.
  bool Add(const PageLine& line) {
    ++line_;
    const std::size_t n = line.points.size(), segments = line.closed ? n : n - 1;
    for (std::size_t i = 0; i < segments; ++i) {
      const Complex a = line.points[i], b = line.points[(i + 1) % n];
      const auto [low, high] = std::minmax({a.imag(), b.imag()});
      const auto [first_row, last_row] = grid_.Rows(low, high);
      for (std::size_t row = first_row; row <= last_row; ++row) {
        if (!AddInRow(line, a, b, i, row)) return false;
      }
    }
    return true;
  }

 private:
  struct End {
    std::size_t line = 0, segment = 0;
  };

  // A window and what is so near that its width may be seen.
  Bounds Seen(std::size_t row, std::size_t column) const {
    constexpr double kNear = 1;
    const Bounds w = grid_.Window(row, column);
    return {w.min_x - kNear, w.min_y - kNear, w.max_x + kNear, w.max_y + kNear, false};
  }

  // To the pages of a row. What is outside of a page is left out, because files of pages do not
  // know places that are far away.
  bool AddInRow(const PageLine& line, Complex a, Complex b, std::size_t segment, std::size_t row) {
    Bounds strip = Seen(row, 0);
    strip.min_x = -INFINITY;
    strip.max_x = INFINITY;
    const auto inside = Clipped(a, b, strip);
    if (!inside) return true;
    const auto [low, high] = std::minmax({inside->first.real(), inside->second.real()});
    const auto [first, last] = grid_.Columns(low, high);
    for (std::size_t column = first; column <= last; ++column) {
      const auto part = Clipped(inside->first, inside->second, Seen(row, column));
      if (!part) continue;
      if (left_-- == 0) return false;
      AddPart(line, segment, *part, part->first == a, part->second == b,
              grid_.NumberOf(row, column) - 1, grid_.Shift(row, column));
    }
    return true;
  }

  // `from_start` and `to_end`: it is not cut off there.
  void AddPart(const PageLine& line, std::size_t segment, const std::pair<Complex, Complex>& part,
               bool from_start, bool to_end, std::size_t page, Complex shift) {
    std::vector<PageLine>& drawing = pages_[page].drawing;
    const End& end = ends_[page];
    if (!from_start || end.line != line_ || end.segment != segment) {
      drawing.push_back({line.ink, false, {part.first + shift}});
    }
    PageLine& drawn = drawing.back();
    // All of a closed line is closed here too.
    if (line.closed && to_end && drawn.points.size() == line.points.size() &&
        drawn.points.front() == line.points.front() + shift) {
      drawn.closed = true;
    } else {
      drawn.points.push_back(part.second + shift);
    }
    ends_[page] = to_end ? End{line_, segment + 1} : End{};
  }

  const PageGrid& grid_;
  std::size_t left_;
  std::vector<Page>& pages_;
  std::vector<End> ends_;  // of each page, what was drawn last on it
  std::size_t line_ = 0;
};

}  // namespace

bool Distribute(const std::vector<PageLine>& lines, const PageGrid& grid, std::size_t most,
                std::vector<Page>& pages) {
  Distributor distributor(grid, most, pages);
  return std::all_of(lines.begin(), lines.end(),
                     [&](const PageLine& line) { return distributor.Add(line); });
}

std::vector<bool> MiddlesOn(std::span<const Triangle> triangles, std::span<const Complex> points,
                            const PageGrid& grid) {
  const auto pages = static_cast<std::size_t>(grid.pages());
  std::vector<bool> on(pages, false);
  std::size_t left = 8 * triangles.size() + 200'000;  // pages to look at
  for (const Triangle& t : triangles) {
    Bounds box;
    for (const std::uint32_t u : t) box.Add(points[u]);
    const auto [first_row, last_row] = grid.Rows(box.min_y, box.max_y);
    for (std::size_t row = first_row; row <= last_row; ++row) {
      // From where to where the triangle is on the line through the middles of the row.
      const Bounds strip = grid.Window(row, 0);
      const double y = (strip.min_y + strip.max_y) / 2;
      double from = INFINITY, to = -INFINITY;
      for (std::size_t k = 0; k < 3; ++k) {
        const Complex a = points[t[k]], b = points[t[(k + 1) % 3]];
        if ((a.imag() <= y) == (b.imag() <= y)) continue;
        const double part = (y - a.imag()) / (b.imag() - a.imag());
        const double x = a.real() + part * (b.real() - a.real());
        from = std::min(from, x);
        to = std::max(to, x);
      }
      if (left-- == 0) return std::vector<bool>(pages, true);
      if (from > to) continue;
      const auto [first, last] = grid.Columns(from, to);
      for (std::size_t column = first; column <= last; ++column) {
        if (left-- == 0) return std::vector<bool>(pages, true);
        const Bounds window = grid.Window(row, column);
        const double x = (window.min_x + window.max_x) / 2;
        if (from <= x && x <= to) on[grid.NumberOf(row, column) - 1] = true;
      }
    }
  }
  return on;
}

}  // namespace arap
