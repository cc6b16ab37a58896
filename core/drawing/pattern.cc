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

// The segments of cuts that were drawn, by their places in nanometres: a slit that does not open
// has both of its sides in one place.
class DrawnCuts {
 public:
  // False when it was drawn before.
  bool Add(Complex a, Complex b) {
    return drawn_.insert(std::minmax(Rounded(a), Rounded(b))).second;
  }

 private:
  using Place = std::pair<std::int64_t, std::int64_t>;
  static Place Rounded(Complex p) {
    const auto rounded = [](double x) {
      constexpr double kFarthest = 9e18;
      return static_cast<std::int64_t>(std::clamp(1e6 * x, -kFarthest, kFarthest));
    };
    return {rounded(p.real()), rounded(p.imag())};
  }

  std::set<std::pair<Place, Place>> drawn_;
};

// Cuts a closed loop where outline and seam meet, and leaves out what was drawn.
void AddLoop(const Loop& loop, const Flattening& flat, const EdgeSet& cuts,
             std::span<const Complex> points, DrawnCuts& drawn, PatternPiece& piece) {
  enum Edge { kOutline, kSeam, kDrawn };
  const std::size_t n = loop.size();
  std::vector<Edge> edges(n, kOutline);  // the edge after each vertex
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t a = loop[i], b = loop[(i + 1) % n];
    if (!cuts.Has(flat.source[a], flat.source[b])) continue;
    edges[i] = drawn.Add(points[a], points[b]) ? kSeam : kDrawn;
  }
  std::size_t start = 0;
  while (start < n && edges[start] == edges[(start + n - 1) % n]) ++start;
  if (start == n) {
    if (n == 0 || edges[0] == kDrawn) return;
    PatternLine& line = piece.lines.emplace_back();
    line.kind = edges[0] == kSeam ? LineKind::kSeam : LineKind::kOutline;
    line.closed = true;
    for (const std::uint32_t u : loop) line.points.push_back(points[u]);
    return;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (start + k) % n;
    if (edges[i] == kDrawn) continue;
    if (edges[i] != edges[(i + n - 1) % n]) {
      PatternLine& line = piece.lines.emplace_back();
      line.kind = edges[i] == kSeam ? LineKind::kSeam : LineKind::kOutline;
      line.points.push_back(points[loop[i]]);
    }
    piece.lines.back().points.push_back(points[loop[(i + 1) % n]]);
  }
}

// The piece of each flat position.
std::vector<std::uint32_t> Pieces(const Flattening& flat) {
  std::vector<std::uint32_t> pieces(flat.uv.size(), kNoPiece);
  for (std::size_t t = 0; t < std::min(flat.corner_uv.size(), flat.triangle_chart.size()); ++t) {
    for (const std::uint32_t u : flat.corner_uv[t]) pieces[u] = flat.triangle_chart[t];
  }
  return pieces;
}

// The flat positions that a grain line goes between. Seams double vertices: of the copies on one
// chart, those that point best where they were asked to.
std::optional<std::pair<std::uint32_t, std::uint32_t>> EndsOf(
    const GrainLine& line, const Flattening& flat, std::span<const std::uint32_t> pieces) {
  const Complex wanted = std::polar(1.0, line.angle);
  std::optional<std::pair<std::uint32_t, std::uint32_t>> best;
  double best_cosine = -2;
  const auto copies = [&](std::uint32_t vertex) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t u = 0; u < pieces.size(); ++u) {
      if (flat.source[u] == vertex && pieces[u] != kNoPiece) found.push_back(u);
    }
    return found;
  };
  const auto ends = copies(line.to);
  for (const std::uint32_t from : copies(line.from)) {
    for (const std::uint32_t to : ends) {
      const Complex along = flat.uv[to] - flat.uv[from];
      if (pieces[from] != pieces[to] || along == 0.0) continue;
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

Bounds BoxOf(const PatternPiece& piece) {
  Bounds box;
  for (const PatternLine& line : piece.lines) box.Add(line.points);
  return box;
}

void Move(const std::vector<Complex>& moves, Pattern& pattern) {
  for (std::size_t u = 0; u < pattern.points.size(); ++u) {
    if (pattern.piece_of[u] < moves.size()) pattern.points[u] += moves[pattern.piece_of[u]];
  }
  for (std::size_t i = 0; i < moves.size(); ++i) {
    PatternPiece& piece = pattern.pieces[i];
    for (PatternLine& line : piece.lines) {
      for (Complex& p : line.points) p += moves[i];
    }
    piece.box = piece.box.Moved(moves[i]);
  }
}

Status AddAllowance(const Flattening& flat, double width, Pattern& pattern) {
  std::vector<Bounds> boxes;
  BorderBudget budget;
  for (std::size_t c = 0; c < flat.charts.size(); ++c) {
    std::vector<Ring> rings;
    for (const Loop& loop : flat.charts[c].loops) {
      Ring& ring = rings.emplace_back();
      for (const std::uint32_t u : loop) ring.push_back(pattern.points[u]);
    }
    TRY(std::vector<Ring> borders, OffsetOutwards(rings, width, budget));
    for (Ring& ring : borders) {
      pattern.pieces[c].lines.push_back({LineKind::kAllowance, /*closed=*/true, std::move(ring)});
    }
    boxes.push_back(BoxOf(pattern.pieces[c]));
  }
  if (AnyTouch(boxes)) Move(SetOut(boxes, width), pattern);
  return {};
}

}  // namespace

Bounds Pattern::Box() const {
  Bounds box;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t u : t) box.Add(points[u]);
  }
  for (const PatternPiece& piece : pieces) {
    for (const PatternLine& line : piece.lines) box.Add(line.points);
  }
  return box;
}

Result<Pattern> MakePattern(const Flattening& flat, const PatternOptions& options) {
  Pattern pattern;
  pattern.points = flat.uv;
  for (Complex& p : pattern.points) p *= options.millimetres_per_unit;
  pattern.piece_of = Pieces(flat);
  pattern.triangles = flat.corner_uv;
  pattern.singular_values = flat.singular_values;
  const EdgeSet cuts(flat.cuts);
  DrawnCuts drawn;
  for (const FlatChart& chart : flat.charts) {
    PatternPiece& piece = pattern.pieces.emplace_back();
    for (const Loop& loop : chart.loops) {
      AddLoop(loop, flat, cuts, pattern.points, drawn, piece);
    }
  }
  for (std::size_t u = 0; u < pattern.points.size(); ++u) {
    if (pattern.piece_of[u] >= pattern.pieces.size()) continue;
    pattern.pieces[pattern.piece_of[u]].box.Add(pattern.points[u]);
  }
  for (const GrainLine& line : options.grain_lines) {
    if (const auto ends = EndsOf(line, flat, pattern.piece_of)) {
      PatternPiece& piece = pattern.pieces[pattern.piece_of[ends->first]];
      piece.lines.push_back({LineKind::kGrain,
                             /*closed=*/false,
                             {pattern.points[ends->first], pattern.points[ends->second]}});
    }
  }
  if (options.allowance > 0) CHECK_OK(AddAllowance(flat, options.allowance, pattern));
  return pattern;
}

int DigitsFor(const Pattern& pattern) {
  double smallest = INFINITY;
  for (const PatternPiece& piece : pattern.pieces) {
    for (const double side : {piece.box.width(), piece.box.height()}) {
      if (side > 0) smallest = std::min(smallest, side);
    }
  }
  if (!std::isfinite(smallest)) return 3;
  return static_cast<int>(std::clamp(std::ceil(4 - std::log10(smallest)), 3.0, 9.0));
}

}  // namespace arap
