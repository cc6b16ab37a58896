#include "core/outline/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace arap {

PixelSide PixelSide::Next(const Coverage& coverage) const {
  // Straight on along the border is a quarter turn to the left of the way outside.
  const PixelSide left{x, y, (direction + 1) % 4};
  const std::ptrdiff_t ahead_x = left.beyond_x(), ahead_y = left.beyond_y();
  const PixelSide straight{ahead_x, ahead_y, direction};
  const PixelSide right{straight.beyond_x(), straight.beyond_y(), (direction + 3) % 4};
  if (coverage.Inside(right.x, right.y)) return right;
  return coverage.Inside(straight.x, straight.y) ? straight : left;
}

Borders::Borders(const Coverage& coverage)
    : coverage_(coverage), seen_(coverage.values.size(), false) {}

bool Borders::Find() {
  const auto width = static_cast<std::ptrdiff_t>(coverage_.width);
  for (; next_ < seen_.size(); ++next_) {
    const auto at = static_cast<std::ptrdiff_t>(next_);
    const std::ptrdiff_t x = at % width, y = at / width;
    if (seen_[next_] || !coverage_.Inside(x, y) || coverage_.Inside(x, y - 1)) continue;
    start_ = {x, y, PixelSide::kUp};
    area_ = 0;
    PixelSide side = start_;
    do {
      // Upper sides run to the left, lower ones to the right: columns of pixels between them.
      if (side.direction == PixelSide::kUp) {
        seen_[static_cast<std::size_t>(side.y * width + side.x)] = true;
        area_ -= side.y;
      } else if (side.direction == PixelSide::kUp + 2) {
        area_ += side.y + 1;
      }
      side = side.Next(coverage_);
    } while (side != start_);
    ++next_;
    return true;
  }
  return false;
}

namespace {

// Gives the pixels that hang together with (x, y), inside or outside like it, another value.
void Flood(std::ptrdiff_t x, std::ptrdiff_t y, std::uint8_t value, Coverage& coverage) {
  const bool inside = coverage.Inside(x, y);
  std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> waiting;
  const auto take = [&](std::ptrdiff_t px, std::ptrdiff_t py) {
    const auto column = static_cast<std::size_t>(px), row = static_cast<std::size_t>(py);
    if (column >= coverage.width || row >= coverage.height) return;
    if (coverage.Inside(px, py) != inside) return;
    coverage.values[row * coverage.width + column] = value;
    waiting.emplace_back(px, py);
  };
  take(x, y);
  while (!waiting.empty()) {
    const auto [px, py] = waiting.back();
    waiting.pop_back();
    for (std::ptrdiff_t dy = -1; dy <= 1; ++dy) {
      for (std::ptrdiff_t dx = -1; dx <= 1; ++dx) {
        if (inside || dx == 0 || dy == 0) take(px + dx, py + dy);
      }
    }
  }
}

}  // namespace

Dropped DropSpecks(std::size_t least, std::size_t least_hole, Coverage& coverage) {
  Dropped dropped;
  Borders borders(coverage);
  while (borders.Find()) {
    const PixelSide start = borders.start();
    const auto pixels = static_cast<std::size_t>(std::abs(borders.area()));
    if (borders.area() > 0 && pixels < least) {
      ++dropped.pieces;
      dropped.largest_piece = std::max(dropped.largest_piece, pixels);
      Flood(start.x, start.y, 0, coverage);
    } else if (borders.area() < 0 && pixels < least_hole) {
      ++dropped.holes;
      Flood(start.beyond_x(), start.beyond_y(), 255, coverage);
    }
  }
  return dropped;
}

namespace {

// How far it is up or down to the next pixel inside; more than `far` counts as nothing there.
std::vector<std::uint16_t> VerticalDistances(const Coverage& coverage, std::size_t far) {
  const std::size_t width = coverage.width, height = coverage.height;
  std::vector<std::uint16_t> distances(width * height);
  std::vector<std::size_t> column(width, far);
  const auto pass = [&](std::size_t row, bool first) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = row * width + x;
      column[x] = coverage.values[at] >= kInside ? 0 : std::min(column[x] + 1, far);
      if (!first) column[x] = std::min<std::size_t>(column[x], distances[at]);
      distances[at] = static_cast<std::uint16_t>(column[x]);
    }
  };
  for (std::size_t row = 0; row < height; ++row) pass(row, true);
  column.assign(width, far);
  for (std::size_t row = height; row-- > 0;) pass(row, false);
  return distances;
}

// The lower envelope of parabolas x ↦ (x − at)² + height.
class Envelope {
 public:
  void Clear() { arcs_.clear(); }
  // With growing `at`.
  void Add(std::int64_t at, std::int64_t height) {
    const Arc arc{at, height, std::numeric_limits<std::int64_t>::min()};
    while (!arcs_.empty() && arcs_.back().from >= Crossing(arcs_.back(), arc)) arcs_.pop_back();
    arcs_.push_back(arc);
    if (arcs_.size() > 1) arcs_.back().from = Crossing(arcs_[arcs_.size() - 2], arc);
    now_ = 0;
  }
  bool empty() const { return arcs_.empty(); }
  // With growing x.
  std::int64_t At(std::int64_t x) {
    while (now_ + 1 < arcs_.size() && arcs_[now_ + 1].from <= x) ++now_;
    return (x - arcs_[now_].at) * (x - arcs_[now_].at) + arcs_[now_].height;
  }

 private:
  struct Arc {
    std::int64_t at, height, from;
  };
  // The first x at which the later one is not above the earlier one.
  static std::int64_t Crossing(const Arc& a, const Arc& b) {
    const std::int64_t over = b.at * b.at + b.height - a.at * a.at - a.height;
    const std::int64_t under = 2 * (b.at - a.at);
    return over >= 0 ? (over + under - 1) / under : -(-over / under);
  }

  std::vector<Arc> arcs_;
  std::size_t now_ = 0;
};

Coverage WithMargin(const Coverage& coverage, std::size_t margin) {
  Coverage wide{
      coverage.width + 2 * margin, coverage.height + 2 * margin, coverage.margin + margin, {}};
  wide.values.assign(wide.width * wide.height, 0);
  for (std::size_t row = 0; row < coverage.height; ++row) {
    const auto from = coverage.values.begin() + static_cast<std::ptrdiff_t>(row * coverage.width);
    std::copy_n(
        from, coverage.width,
        wide.values.begin() + static_cast<std::ptrdiff_t>((row + margin) * wide.width + margin));
  }
  return wide;
}

}  // namespace

Coverage Expand(const Coverage& coverage, double distance) {
  const auto far = static_cast<std::size_t>(std::ceil(distance)) + 2;
  Coverage wide = WithMargin(coverage, far);
  const std::vector<std::uint16_t> vertical = VerticalDistances(wide, far);
  // The centre of a pixel lies half a pixel inside its border.
  const double reach = distance + 0.5;
  Envelope envelope;
  for (std::size_t row = 0; row < wide.height; ++row) {
    envelope.Clear();
    for (std::size_t x = 0; x < wide.width; ++x) {
      const std::int64_t up = vertical[row * wide.width + x];
      if (up < static_cast<std::int64_t>(far)) envelope.Add(static_cast<std::int64_t>(x), up * up);
    }
    for (std::size_t x = 0; x < wide.width; ++x) {
      const double away =
          envelope.empty()
              ? reach + 2
              : std::sqrt(static_cast<double>(envelope.At(static_cast<std::int64_t>(x))));
      // Steep enough to be exact between two pixels, flat enough to reach from one to the other.
      const double value = 127.5 + 90 * (reach - away);
      wide.values[row * wide.width + x] =
          static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  }
  return wide;
}

}  // namespace arap
