// Notches: marks that pair the two sides of every seam.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/drawing/pattern_steps.h"

namespace arap {
namespace {

constexpr double kShortestStretch = 6, kNotch = 4, kLetters = 3;  // millimetres

// An edge of an outline that was cut, one side of the cut.
struct Side {
  std::uint32_t piece = 0;
  std::uint32_t from = 0, to = 0;     // flat positions, the piece on the left
  std::size_t before = 0, after = 0;  // the edges of the outline next to it; kNone: no cut
  std::size_t twin = SIZE_MAX;        // the other side; kNone: more or fewer than one
  bool numbered = false;
};
constexpr std::size_t kNone = SIZE_MAX;

// All sides in the order of the outlines, with their neighbours and twins.
std::vector<Side> SidesOf(const Flattening& flat) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> cuts;
  for (const auto& [a, b] : flat.cuts) cuts.insert(std::minmax(a, b));
  std::vector<Side> sides;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> by_edge;
  for (std::uint32_t c = 0; c < flat.charts.size(); ++c) {
    for (const auto& loop : flat.charts[c].loops) {
      const std::size_t n = loop.size();
      std::vector<std::size_t> at(n, kNone);
      for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t u = loop[i], v = loop[(i + 1) % n];
        const std::pair<std::uint32_t, std::uint32_t> edge =
            std::minmax(flat.source[u], flat.source[v]);
        if (!cuts.contains(edge)) continue;
        at[i] = sides.size();
        by_edge[edge].push_back(sides.size());
        sides.push_back({c, u, v});
      }
      for (std::size_t i = 0; i < n; ++i) {
        if (at[i] == kNone) continue;
        sides[at[i]].before = at[(i + n - 1) % n];
        sides[at[i]].after = at[(i + 1) % n];
      }
    }
  }
  for (const auto& [edge, both] : by_edge) {
    if (both.size() != 2) continue;
    sides[both[0]].twin = both[1];
    sides[both[1]].twin = both[0];
  }
  return sides;
}

// The side after `s`, when the sides across go on together; else kNone.
std::size_t Next(const std::vector<Side>& sides, std::size_t s) {
  const std::size_t next = sides[s].after;
  if (next == kNone || sides[next].numbered || sides[next].twin == kNone) return kNone;
  return sides[next].twin == sides[sides[s].twin].before ? next : kNone;
}
std::size_t Previous(const std::vector<Side>& sides, std::size_t s) {
  const std::size_t last = sides[s].before;
  if (last == kNone || sides[last].numbered || sides[last].twin == kNone) return kNone;
  return sides[last].twin == sides[sides[s].twin].after ? last : kNone;
}

// A notch at a part of the way along a side, with its number.
void AddNotch(const Side& side, double part, double size, double allowance,
              const std::string& number, Pattern& pattern) {
  const Complex from = pattern.points[side.from], along = pattern.points[side.to] - from;
  if (along == 0.0) return;
  const Complex at = from + part * along;
  const Complex inwards = along / std::abs(along) * Complex(0, 1);
  const double length = size * kNotch;
  const Complex end =
      allowance > 0 ? at - std::min(length, allowance) * inwards : at + length * inwards;
  PatternPiece& piece = pattern.pieces[side.piece];
  piece.lines.push_back({LineKind::kNotch, /*closed=*/false, {at, end}});
  const double beside = size * (allowance > 0 ? kLetters : kNotch + kLetters);
  piece.labels.push_back({at + beside * inwards, size * kLetters, number});
}

}  // namespace

void AddNotches(const Flattening& flat, double allowance, Pattern& pattern) {
  std::vector<Side> sides = SidesOf(flat);
  const auto length = [&](const Side& side) {
    return std::abs(pattern.points[side.to] - pattern.points[side.from]);
  };
  std::size_t number = 0;
  for (std::size_t s = 0; s < sides.size(); ++s) {
    if (sides[s].numbered || sides[s].twin == kNone) continue;
    // To where the stretch begins, but not round and round where all of a loop is one.
    std::size_t first = s;
    for (std::size_t last = Previous(sides, first); last != kNone && last != s;
         last = Previous(sides, first)) {
      // At the end of a slit the way goes on along its own other side.
      if (last == sides[first].twin) break;
      first = last;
    }
    std::vector<std::size_t> stretch;
    double total = 0;
    for (std::size_t at = first; at != kNone; at = Next(sides, at)) {
      sides[at].numbered = sides[sides[at].twin].numbered = true;
      stretch.push_back(at);
      total += length(sides[at]);
    }
    if (!(total >= kShortestStretch)) continue;
    // The same place on both sides: the same part of the same edge.
    double left = total / 2;
    std::size_t k = 0;
    while (k + 1 < stretch.size() && left > length(sides[stretch[k]])) {
      left -= length(sides[stretch[k++]]);
    }
    const Side& side = sides[stretch[k]];
    const double part = std::clamp(left / length(side), 0.0, 1.0);
    const double size = std::min(1.0, total / 30);
    const std::string text = std::to_string(++number);
    AddNotch(side, part, size, allowance, text, pattern);
    AddNotch(sides[side.twin], 1 - part, size, allowance, text, pattern);
  }
}

}  // namespace arap
