#include "core/flatten/sheet/pack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/plane.h"

namespace arap {
namespace {

// A rectangle must be smaller, or longer than wide, by this part to be worth turning for, so that
// rounding decides nothing.
constexpr double kWorthTurning = 1e-9;
// Lengths of shelf to try, relative to the side of a square of the same area: from, to, how many.
constexpr double kShortestShelf = 0.8, kLongestShelf = 1.6;
constexpr int kShelves = 17;

// Leaves out points well inside of the farthest ones in eight directions, which are on no hull: most points of
// a chart.
void DropInside(std::vector<Complex>& points) {
  constexpr std::size_t kHandful = 64;
  if (points.size() < kHandful) return;
  // How far a point is in each direction, counter-clockwise.
  const auto reach = [](Complex p) {
    const double x = p.real(), y = p.imag();
    return std::array<double, 8>{x, x + y, y, y - x, -x, -x - y, -y, x - y};
  };
  std::array<Complex, 8> corner;
  corner.fill(points.front());
  std::array<double, 8> farthest = reach(points.front());
  for (const Complex p : points) {
    const auto own = reach(p);
    for (std::size_t k = 0; k < 8; ++k) {
      if (own[k] > farthest[k]) farthest[k] = own[k], corner[k] = p;
    }
  }
  constexpr double kWellInside = 1e-9;
  const double width = farthest[0] + farthest[4], height = farthest[2] + farthest[6];
  const double margin = kWellInside * (width * width + height * height);
  const auto inside = [&](Complex p) {
    for (std::size_t k = 0; k < 8; ++k) {
      const Complex from = corner[k], side = corner[(k + 1) % 8] - from;
      if (side != Complex(0) && !(Cross(side, p - from) > margin)) return false;
    }
    return margin > 0;
  };
  points.erase(std::remove_if(points.begin(), points.end(), inside), points.end());
}

// Convex hull, counter-clockwise, without points on its sides [Andrew's monotone chain].
std::vector<Complex> Hull(std::vector<Complex> points) {
  DropInside(points);
  const auto before = [](Complex a, Complex b) {
    return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Complex> hull;
  const auto add = [&hull](Complex p, std::size_t keep) {
    while (hull.size() > keep && Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const Complex p : points) add(p, 1);
  const std::size_t lower = hull.size();
  for (std::size_t k = points.size() - 1; k-- > 0;) add(points[k], lower);
  hull.pop_back();
  return hull;
}

struct Extent {
  Complex low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Complex high = -low;

  void Include(Complex p) {
    low = {std::min(low.real(), p.real()), std::min(low.imag(), p.imag())};
    high = {std::max(high.real(), p.real()), std::max(high.imag(), p.imag())};
  }
  double width() const { return high.real() - low.real(); }
  double height() const { return high.imag() - low.imag(); }
};

// A chart to be packed: its vertices and its bounding box after the turn.
struct Tile {
  std::vector<std::uint32_t> vertices;
  Extent extent;
};

std::vector<Tile> Collect(std::span<const std::uint32_t> chart) {
  std::vector<Tile> tiles;
  for (std::uint32_t v = 0; v < chart.size(); ++v) {
    if (chart[v] == kNone) continue;
    if (chart[v] >= tiles.size()) tiles.resize(std::size_t{chart[v]} + 1);
    tiles[chart[v]].vertices.push_back(v);
  }
  return tiles;
}

// Highest first, then by number; without empty ones.
std::vector<std::uint32_t> ByHeight(const std::vector<Tile>& tiles) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t c = 0; c < tiles.size(); ++c) {
    if (!tiles[c].vertices.empty()) order.push_back(c);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return tiles[a].extent.height() > tiles[b].extent.height();
  });
  return order;
}

// The lowest left corners of charts on shelves of length `shelf`, in the order given.
struct Sheet {
  std::vector<Complex> corners;
  double width = 0, height = 0;
};

Sheet FillShelves(const std::vector<Tile>& tiles, const std::vector<std::uint32_t>& order,
                  double shelf, double gap) {
  Sheet sheet;
  double x = 0, y = 0;
  for (const std::uint32_t c : order) {
    const Extent& extent = tiles[c].extent;
    if (x > 0 && x + extent.width() > shelf) {
      x = 0;
      y = sheet.height + gap;
    }
    sheet.corners.emplace_back(x, y);
    sheet.width = std::max(sheet.width, x + extent.width());
    sheet.height = std::max(sheet.height, y + extent.height());
    x += extent.width() + gap;
  }
  return sheet;
}

// The sheet with the shortest longer side.
Sheet BestSheet(const std::vector<Tile>& tiles, const std::vector<std::uint32_t>& order,
                double gap) {
  double area = 0, widest = 0;
  for (const std::uint32_t c : order) {
    const Extent& extent = tiles[c].extent;
    area += (extent.width() + gap) * (extent.height() + gap);
    widest = std::max(widest, extent.width());
  }
  Sheet best;
  for (int k = 0; k < kShelves; ++k) {
    const double length = kShortestShelf + (kLongestShelf - kShortestShelf) * k / (kShelves - 1);
    Sheet sheet = FillShelves(tiles, order, std::max(widest, length * std::sqrt(area)), gap);
    if (k == 0 || std::max(sheet.width, sheet.height) < std::max(best.width, best.height)) {
      best = std::move(sheet);
    }
  }
  return best;
}

}  // namespace

Complex UprightTurn(std::vector<Complex> points) {
  const std::vector<Complex> hull = Hull(std::move(points));
  const std::size_t n = hull.size();
  if (n < 2) return 1;
  Extent own;
  for (const Complex p : hull) own.Include(p);
  const auto upright = [](Complex direction) {
    return direction.real() < 0 ? -std::conj(direction) : std::conj(direction);
  };
  if (n == 2) return upright((hull[1] - hull[0]) / std::abs(hull[1] - hull[0]));
  double least = own.width() * own.height();
  Complex turn = own.height() > own.width() * (1 + kWorthTurning) ? Complex(0, 1) : Complex(1);
  // A smallest rectangle has a side along a hull edge. Its other three touch the hull at points
  // that move on as the edge does [rotating calipers].
  std::size_t right = 1, top = 1, left = 1;
  for (std::size_t k = 0; k < n; ++k) {
    const Complex from = hull[k];
    const Complex direction = (hull[(k + 1) % n] - from) / std::abs(hull[(k + 1) % n] - from);
    const auto along = [&](std::size_t i) { return Dot(direction, hull[i % n] - from); };
    const auto above = [&](std::size_t i) { return Cross(direction, hull[i % n] - from); };
    right = std::max(right, k + 1);
    while (along(right + 1) > along(right)) ++right;
    top = std::max(top, right);
    while (above(top + 1) > above(top)) ++top;
    left = std::max(left, top);
    while (along(left + 1) < along(left)) ++left;
    const double width = along(right) - along(left), height = above(top);
    if (width * height < least * (1 - kWorthTurning)) {
      least = width * height;
      turn = upright(width >= height ? direction : direction * Complex(0, 1));
    }
  }
  return turn;
}

std::vector<Motion> PackCharts(std::span<Complex> uv, std::span<const std::uint32_t> chart,
                               const PackOptions& options) {
  std::vector<Tile> tiles = Collect(chart);
  std::vector<Motion> motions(tiles.size());
  const auto used = std::count_if(tiles.begin(), tiles.end(),
                                  [](const Tile& tile) { return !tile.vertices.empty(); });
  if (used < 2) return motions;
  double sides = 0;
  for (std::size_t c = 0; c < tiles.size(); ++c) {
    std::vector<Complex> points;
    for (const std::uint32_t v : tiles[c].vertices) points.push_back(uv[v]);
    if (points.empty()) continue;
    Complex& turn = motions[c].rotation;
    if (options.rotate) turn = UprightTurn(points);
    for (const Complex p : points) tiles[c].extent.Include(turn * p);
    sides += 0.5 * (tiles[c].extent.width() + tiles[c].extent.height());
  }
  const double gap = options.gap * sides / static_cast<double>(used);
  const std::vector<std::uint32_t> order = ByHeight(tiles);
  const Sheet sheet = BestSheet(tiles, order, gap);
  for (std::size_t k = 0; k < order.size(); ++k) {
    Motion& motion = motions[order[k]];
    motion.shift = sheet.corners[k] - tiles[order[k]].extent.low;
    for (const std::uint32_t v : tiles[order[k]].vertices) {
      uv[v] = motion.rotation * uv[v] + motion.shift;
    }
  }
  return motions;
}

void PlaceCharts(std::span<const Wishes> wishes, std::span<const std::uint32_t> chart,
                 std::vector<Complex>& uv, std::vector<Complex>& first_step) {
  std::vector<std::vector<Complex>> points(wishes.size());
  for (std::size_t v = 0; v < chart.size(); ++v) {
    if (chart[v] != kNone) points[chart[v]].push_back(uv[v]);
  }
  // A chart turns about its single pin, which so stays where it is to the last bit.
  std::vector<Complex> turns(wishes.size(), 1), centres(wishes.size());
  std::size_t free_charts = 0;
  for (std::uint32_t c = 0; c < wishes.size(); ++c) {
    if (wishes[c].pins.empty()) ++free_charts;
    if (wishes[c].grain || wishes[c].pinned()) continue;
    turns[c] = UprightTurn(std::move(points[c]));
    if (!wishes[c].pins.empty()) centres[c] = wishes[c].pins.front().uv;
  }
  // Pinned charts keep their place and the sheet of the others begins right of them.
  double right = -std::numeric_limits<double>::infinity(), low = 0;
  std::vector<std::uint32_t> free(chart.size(), kNone);
  for (std::size_t v = 0; v < chart.size(); ++v) {
    const std::uint32_t c = chart[v];
    if (c == kNone) continue;
    if (turns[c] != 1.0) {
      uv[v] = turns[c] * (uv[v] - centres[c]) + centres[c];
      first_step[v] = turns[c] * (first_step[v] - centres[c]) + centres[c];
    }
    if (wishes[c].pins.empty()) {
      free[v] = c;
    } else if (uv[v].real() > right) {
      right = uv[v].real(), low = uv[v].imag();
    }
  }
  if (free_charts == 0) return;
  const auto motions = PackCharts(uv, free, {.gap = 0.05, .rotate = false});
  Extent sheet;
  for (std::size_t v = 0; v < free.size(); ++v) {
    if (free[v] == kNone) continue;
    first_step[v] += motions[free[v]].shift;
    sheet.Include(uv[v]);
  }
  // Beside the pinned ones, a twentieth of the sheet away.
  Complex shift = -sheet.low;
  if (free_charts < wishes.size()) shift += Complex(right + 0.05 * sheet.width(), low);
  for (std::size_t v = 0; v < free.size(); ++v) {
    if (free[v] == kNone) continue;
    uv[v] += shift;
    first_step[v] += shift;
  }
}

}  // namespace arap
