#include "core/drawing/pattern.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "core/base/try.h"

namespace arap {
namespace {

using Loop = std::vector<std::uint32_t>;

// Edges as pairs of vertices in either order.
class EdgeSet {
 public:
  explicit EdgeSet(std::span<const std::array<std::uint32_t, 2>> pairs) {
    for (const auto& [a, b] : pairs) edges_.insert(std::minmax(a, b));
  }
  bool Has(std::uint32_t a, std::uint32_t b) const { return edges_.contains(std::minmax(a, b)); }

 private:
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;
};

// The runs of edges of a closed loop that are cuts. A loop of cuts only repeats its first vertex.
std::vector<Loop> CutRuns(const Loop& loop, const Flattening& flat, const EdgeSet& cuts) {
  const std::size_t n = loop.size();
  std::vector<bool> cut(n);  // the edge after each vertex
  for (std::size_t i = 0; i < n; ++i) {
    cut[i] = cuts.Has(flat.source[loop[i]], flat.source[loop[(i + 1) % n]]);
  }
  const auto whole = std::find(cut.begin(), cut.end(), false);
  const auto start = static_cast<std::size_t>(whole == cut.end() ? 0 : whole - cut.begin());
  std::vector<Loop> runs;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (start + k) % n;
    if (!cut[i]) continue;
    if (runs.empty() || runs.back().back() != loop[i]) runs.push_back({loop[i]});
    runs.back().push_back(loop[(i + 1) % n]);
  }
  return runs;
}

// The chart of each flat position; positions of no triangle have none.
std::vector<std::optional<std::uint32_t>> Charts(const Flattening& flat) {
  std::vector<std::optional<std::uint32_t>> charts(flat.uv.size());
  for (std::size_t t = 0; t < std::min(flat.corner_uv.size(), flat.triangle_chart.size()); ++t) {
    for (const std::uint32_t u : flat.corner_uv[t]) charts[u] = flat.triangle_chart[t];
  }
  return charts;
}

// The flat positions that a grain line goes between. Seams double vertices: of the copies on one
// chart, those that point best where they were asked to.
std::optional<std::pair<std::uint32_t, std::uint32_t>> EndsOf(
    const GrainLine& line, const Flattening& flat,
    std::span<const std::optional<std::uint32_t>> charts) {
  const Complex wanted = std::polar(1.0, line.angle);
  std::optional<std::pair<std::uint32_t, std::uint32_t>> best;
  double best_cosine = -2;
  const auto copies = [&](std::uint32_t vertex) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t u = 0; u < charts.size(); ++u) {
      if (flat.source[u] == vertex && charts[u]) found.push_back(u);
    }
    return found;
  };
  const auto ends = copies(line.to);
  for (const std::uint32_t from : copies(line.from)) {
    for (const std::uint32_t to : ends) {
      const Complex along = flat.uv[to] - flat.uv[from];
      if (charts[from] != charts[to] || along == 0.0) continue;
      const double cosine = (std::conj(wanted) * along).real() / std::abs(along);
      if (cosine > best_cosine) best = {from, to};
      best_cosine = std::max(cosine, best_cosine);
    }
  }
  return best;
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

// How far to move each box so that all stand in rows about as long as they are high together.
std::vector<Complex> SetOut(const std::vector<Bounds>& boxes, double gap) {
  double area = 0, widest = 0;
  for (const Bounds& box : boxes) {
    area += (box.width() + gap) * (box.height() + gap);
    widest = std::max(widest, box.width());
  }
  const double row_width = std::max(widest, 1.25 * std::sqrt(area));
  std::vector<Complex> moves;
  double x = 0, y = 0, row_height = 0;
  for (const Bounds& box : boxes) {
    if (x > 0 && x + box.width() > row_width) {
      y -= row_height + gap;
      x = row_height = 0;
    }
    moves.emplace_back(x - box.min_x, y - box.max_y);
    x += box.width() + gap;
    row_height = std::max(row_height, box.height());
  }
  return moves;
}

Status AddAllowance(const Flattening& flat, double width,
                    std::span<const std::optional<std::uint32_t>> charts, Pattern& pattern) {
  std::vector<std::vector<Ring>> borders;
  std::vector<Bounds> boxes;
  BorderBudget budget;
  for (const FlatChart& chart : flat.charts) {
    std::vector<Ring> rings;
    for (const Loop& loop : chart.loops) {
      Ring& ring = rings.emplace_back();
      for (const std::uint32_t u : loop) ring.push_back(pattern.points[u]);
    }
    TRY(borders.emplace_back(), OffsetOutwards(rings, width, budget));
    Bounds& box = boxes.emplace_back();
    for (const Ring& ring : borders.back()) box.Add(ring);
  }
  if (AnyTouch(boxes)) {
    const std::vector<Complex> moves = SetOut(boxes, width);
    for (std::size_t u = 0; u < charts.size(); ++u) {
      if (!charts[u] || *charts[u] >= moves.size()) continue;
      pattern.points[u] += moves[*charts[u]];
    }
    for (std::size_t i = 0; i < borders.size(); ++i) {
      for (Ring& ring : borders[i]) {
        for (Complex& p : ring) p += moves[i];
      }
    }
  }
  for (auto& rings : borders) {
    std::move(rings.begin(), rings.end(), std::back_inserter(pattern.allowance));
  }
  return {};
}

}  // namespace

Result<Pattern> MakePattern(const Flattening& flat, const PatternOptions& options) {
  Pattern pattern;
  pattern.points = flat.uv;
  for (Complex& p : pattern.points) p *= options.millimetres_per_unit;
  pattern.triangles = flat.corner_uv;
  pattern.singular_values = flat.singular_values;
  const EdgeSet cuts(flat.cuts);
  for (const FlatChart& chart : flat.charts) {
    for (const Loop& loop : chart.loops) {
      pattern.outlines.push_back(loop);
      for (Loop& run : CutRuns(loop, flat, cuts)) pattern.seams.push_back(std::move(run));
    }
  }
  const auto charts = Charts(flat);
  if (options.allowance > 0) CHECK_OK(AddAllowance(flat, options.allowance, charts, pattern));
  for (const GrainLine& line : options.grain_lines) {
    if (const auto ends = EndsOf(line, flat, charts)) {
      pattern.grain_lines.push_back({pattern.points[ends->first], pattern.points[ends->second]});
    }
  }
  return pattern;
}

}  // namespace arap
