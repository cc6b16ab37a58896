// Where the pieces of a pattern lie.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/pattern_steps.h"

namespace arap {
namespace {

constexpr double kRollGap = 5;

// p ↦ turn·p + shift, where the turn is 1 or i, so that nothing is rounded by it.
struct Motion {
  Complex turn = 1;
  Complex shift;

  Complex operator()(Complex p) const { return turn * p + shift; }
};

Bounds BoxOf(const PatternPiece& piece) {
  Bounds box = piece.box;
  for (const PatternLine& line : piece.lines) box.Add(line.points);
  return box;
}

std::vector<Bounds> BoxesOf(const Pattern& pattern) {
  std::vector<Bounds> boxes;
  for (const PatternPiece& piece : pattern.pieces) boxes.push_back(BoxOf(piece));
  return boxes;
}

void Move(const std::vector<Motion>& motions, Pattern& pattern) {
  for (std::size_t u = 0; u < pattern.points.size(); ++u) {
    const std::uint32_t piece = pattern.piece_of[u];
    if (piece < motions.size()) pattern.points[u] = motions[piece](pattern.points[u]);
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    PatternPiece& piece = pattern.pieces[i];
    for (PatternLine& line : piece.lines) {
      for (Complex& p : line.points) p = motions[i](p);
    }
    for (PatternLabel& label : piece.labels) label.at = motions[i](label.at);
    if (piece.box.empty) continue;
    Bounds moved;
    moved.Add(motions[i]({piece.box.min_x, piece.box.min_y}));
    moved.Add(motions[i]({piece.box.max_x, piece.box.max_y}));
    piece.box = moved;
  }
}

bool Touch(const Bounds& a, const Bounds& b) {
  return a.min_x < b.max_x && b.min_x < a.max_x && a.min_y < b.max_y && b.min_y < a.max_y;
}

bool AnyTouch(std::vector<Bounds> boxes) {
  std::sort(boxes.begin(), boxes.end(),
            [](const Bounds& a, const Bounds& b) { return a.min_x < b.min_x; });
  for (auto box = boxes.begin(); box != boxes.end(); ++box) {
    for (auto next = box + 1; next != boxes.end() && next->min_x < box->max_x; ++next) {
      if (Touch(*box, *next)) return true;
    }
  }
  return false;
}

// A piece as it lies in the roll.
struct Tile {
  double length = 0, across = 0;
  bool turned = false;
};

struct Roll {
  std::vector<Complex> corners;  // the lower left one of each tile
  double length = 0;
};

Roll Fill(const std::vector<Tile>& tiles, double width) {
  std::vector<std::size_t> order(tiles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&tiles](std::size_t a, std::size_t b) {
    return tiles[a].length > tiles[b].length;
  });
  struct Column {
    double x, filled;
  };
  std::vector<Column> columns;
  constexpr std::size_t kLookedAt = 500;  // of the last columns, so that many pieces stay cheap
  Roll roll;
  roll.corners.resize(tiles.size());
  for (const std::size_t i : order) {
    const auto looked_at = static_cast<std::ptrdiff_t>(std::min(columns.size(), kLookedAt));
    auto column = std::find_if(columns.end() - looked_at, columns.end(), [&](const Column& c) {
      return c.filled + kRollGap + tiles[i].across <= width;
    });
    if (column == columns.end()) {
      const double x = columns.empty() ? 0 : roll.length + kRollGap;
      columns.push_back({x, -kRollGap});
      column = std::prev(columns.end());
      roll.length = x + tiles[i].length;
    }
    roll.corners[i] = {column->x, column->filled + kRollGap};
    column->filled += kRollGap + tiles[i].across;
  }
  return roll;
}

bool HasGrain(const PatternPiece& piece) {
  return std::any_of(piece.lines.begin(), piece.lines.end(),
                     [](const PatternLine& line) { return line.kind == LineKind::kGrain; });
}

// All pieces along the roll, or across it, as far as they may and fit.
Result<std::vector<Tile>> Tiles(const Pattern& pattern, const std::vector<Bounds>& boxes,
                                double width, bool across) {
  // Rounding must not keep out what is as wide as the roll.
  const double room = width * (1 + 1e-9);
  std::vector<Tile> tiles;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const double x = boxes[i].width(), y = boxes[i].height();
    const bool free = !HasGrain(pattern.pieces[i]);
    const bool lies = y <= room, stands = free && x <= room;
    if (!lies && !stands) {
      return Fail(
          Fault(FaultKind::kInvalidOption,
                fmt::format("Piece {} needs {:.1f} mm across the roll{}; the sheet is {:.1f} "
                            "mm wide.",
                            i + 1, free ? std::min(x, y) : y,
                            free ? "" : ", as its grain line runs", width))
              .Field("sheet_width")
              .Element(static_cast<std::uint32_t>(i)));
    }
    // The longer side is x where the piece lies as it was laid out.
    const bool turn = stands && (!lies || (across ? x > y : y > x));
    tiles.push_back(turn ? Tile{y, x, true} : Tile{x, y, false});
  }
  return tiles;
}

}  // namespace

void SetApart(double gap, Pattern& pattern) {
  const std::vector<Bounds> boxes = BoxesOf(pattern);
  if (!AnyTouch(boxes)) return;
  double area = 0, widest = 0;
  for (const Bounds& box : boxes) {
    area += (box.width() + gap) * (box.height() + gap);
    widest = std::max(widest, box.width());
  }
  const double row_width = std::max(widest, 1.25 * std::sqrt(area));
  std::vector<Motion> moves;
  double x = 0, y = 0, row_height = 0;
  for (const Bounds& box : boxes) {
    if (x > 0 && x + box.width() > row_width) {
      y -= row_height + gap;
      x = row_height = 0;
    }
    moves.push_back({1, {x - box.min_x, y - box.max_y}});
    x += box.width() + gap;
    row_height = std::max(row_height, box.height());
  }
  Move(moves, pattern);
}

Status PackRoll(double width, Pattern& pattern) {
  const std::vector<Bounds> boxes = BoxesOf(pattern);
  std::vector<Tile> best;
  std::optional<Roll> roll;
  for (const bool across : {false, true}) {
    TRY(std::vector<Tile> tiles, Tiles(pattern, boxes, width, across));
    Roll filled = Fill(tiles, width * (1 + 1e-9));
    if (roll && roll->length <= filled.length) continue;
    best = std::move(tiles);
    roll = std::move(filled);
  }
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    Motion motion;
    Complex low(boxes[i].min_x, boxes[i].min_y);
    if (best[i].turned) {
      motion.turn = Complex(0, 1);
      low = {-boxes[i].max_y, boxes[i].min_x};
    }
    motion.shift = roll->corners[i] - low;
    motions.push_back(motion);
  }
  Move(motions, pattern);
  return {};
}

}  // namespace arap
