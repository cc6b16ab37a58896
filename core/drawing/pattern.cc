#include "core/drawing/pattern.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/pattern_steps.h"

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

// The flat positions that are drawn, by the vertex that each is a copy of and by piece.
class Copies {
 public:
  struct Copy {
    std::uint32_t vertex = 0, piece = 0, position = 0;
    auto operator<=>(const Copy&) const = default;
  };

  Copies(const Flattening& flat, std::span<const std::uint32_t> pieces) {
    for (std::uint32_t u = 0; u < pieces.size(); ++u) {
      if (pieces[u] != kNoPiece) copies_.push_back({flat.source[u], pieces[u], u});
    }
    std::sort(copies_.begin(), copies_.end());
  }

  std::span<const Copy> Of(std::uint32_t vertex) const {
    return Between({vertex, 0, 0}, {vertex, UINT32_MAX, UINT32_MAX});
  }
  // A slit doubles a vertex on one piece; of very many such copies the first ones.
  std::span<const Copy> Of(std::uint32_t vertex, std::uint32_t piece) const {
    constexpr std::size_t kMost = 1000;
    const auto all = Between({vertex, piece, 0}, {vertex, piece, UINT32_MAX});
    return all.first(std::min(all.size(), kMost));
  }

 private:
  std::span<const Copy> Between(const Copy& first, const Copy& last) const {
    const auto begin = std::lower_bound(copies_.begin(), copies_.end(), first);
    return {begin, std::upper_bound(begin, copies_.end(), last)};
  }

  std::vector<Copy> copies_;
};

// The flat positions that a grain line goes between. Seams double vertices: of the copies on one
// piece, those that point best where they were asked to.
std::optional<std::pair<std::uint32_t, std::uint32_t>> EndsOf(GrainLine line,
                                                              const Flattening& flat,
                                                              const Copies& copies) {
  if (!flat.welded.empty()) {
    line.from = flat.welded[line.from];
    line.to = flat.welded[line.to];
  }
  const Complex wanted = std::polar(1.0, line.angle);
  std::optional<std::pair<std::uint32_t, std::uint32_t>> best;
  double best_cosine = -2;
  // Of a vertex that many pieces meet in, only those with the other end are looked at.
  const auto few = std::min(copies.Of(line.from), copies.Of(line.to),
                            [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::uint32_t done = kNoPiece;
  for (const Copies::Copy& copy : few) {
    if (copy.piece == done) continue;
    done = copy.piece;
    for (const auto& from : copies.Of(line.from, copy.piece)) {
      for (const auto& to : copies.Of(line.to, copy.piece)) {
        const Complex along = flat.uv[to.position] - flat.uv[from.position];
        if (along == 0.0) continue;
        const double cosine = (std::conj(wanted) * along).real() / std::abs(along);
        if (cosine > best_cosine) best = {from.position, to.position};
        best_cosine = std::max(cosine, best_cosine);
      }
    }
  }
  return best;
}

// A warning about some pieces: `what` about the first, and how many more there are.
void AddWarning(std::string kind, std::span<const std::uint32_t> pieces, const std::string& what,
                std::vector<Warning>& warnings) {
  if (pieces.empty()) return;
  constexpr std::size_t kNamed = 10;
  const auto named = pieces.first(std::min(pieces.size(), kNamed));
  Warning& warning = warnings.emplace_back();
  warning.kind = std::move(kind);
  warning.count = pieces.size();
  warning.elements.assign(named.begin(), named.end());
  warning.message = fmt::format("the allowance of piece {} {}", pieces.front() + 1, what);
  if (pieces.size() > 1) {
    warning.message += fmt::format("; so it is with {} more pieces", pieces.size() - 1);
  }
}

// What each piece has lost.
std::vector<Warning> LostWarnings(std::span<const std::optional<double>> lost, double width) {
  constexpr double kWorthTelling = 0.2;  // of the width
  std::vector<std::uint32_t> narrow, unknown;
  for (std::uint32_t i = 0; i < lost.size(); ++i) {
    if (!lost[i]) unknown.push_back(i);
    if (lost[i] > kWorthTelling * width) narrow.push_back(i);
  }
  std::vector<Warning> warnings;
  if (!narrow.empty()) {
    AddWarning(
        "allowance_lost", narrow,
        fmt::format("runs into the piece or closes a gap of it: {:.1f} mm of its outline have "
                    "none of their own",
                    *lost[narrow.front()]),
        warnings);
  }
  AddWarning("allowance_unchecked", unknown,
             "winds too narrowly to find out whether it runs into the piece", warnings);
  return warnings;
}

Status AddAllowance(const Flattening& flat, const PatternOptions& options,
                    const CancelToken& cancel, Pattern& pattern) {
  std::vector<std::optional<double>> lost;
  BorderBudget budget;
  for (std::size_t c = 0; c < flat.charts.size(); ++c) {
    CHECK_OK(cancel.Check());
    std::vector<Ring> rings;
    for (const Loop& loop : flat.charts[c].loops) {
      Ring& ring = rings.emplace_back();
      for (const std::uint32_t u : loop) ring.push_back(pattern.points[u]);
    }
    TRY(Allowance allowance, OffsetOutwards(rings, options.allowance, options.corners, budget));
    for (Ring& ring : allowance.rings) {
      pattern.pieces[c].lines.push_back({LineKind::kAllowance, /*closed=*/true, std::move(ring)});
    }
    lost.push_back(allowance.lost);
  }
  pattern.warnings = LostWarnings(lost, options.allowance);
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

std::array<Complex, 3> ArrowHead(const PatternLine& line, double length) {
  const Complex tip = line.points.back(), along = tip - line.points.front();
  const Complex back = -along / std::abs(along) * std::min(length, std::abs(along) / 3);
  return {tip + back * std::polar(1.0, 0.4), tip, tip + back * std::polar(1.0, -0.4)};
}

Result<Pattern> MakePattern(const Flattening& flat, const PatternOptions& options,
                            const CancelToken& cancel) {
  Pattern pattern;
  pattern.points = flat.uv;
  for (Complex& p : pattern.points) p *= options.millimetres_per_unit;
  pattern.piece_of = Pieces(flat);
  pattern.triangles = flat.corner_uv;
  pattern.singular_values = flat.singular_values;
  // As answers have them, so that what is drawn of an answer is what the server draws.
  for (auto& [s1, s2] : pattern.singular_values) {
    s1 = static_cast<float>(s1);
    s2 = static_cast<float>(s2);
  }
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
  for (std::size_t i = 0; i < std::min(pattern.pieces.size(), options.names.size()); ++i) {
    PatternPiece& piece = pattern.pieces[i];
    piece.name = options.names[i];
    if (piece.name.empty()) continue;
    const Bounds& box = piece.box;
    // A letter is about half as wide as high.
    constexpr double kLetters = 5, kLetterWidth = 0.6;
    const double longest = box.width() / (kLetterWidth * static_cast<double>(piece.name.size()));
    piece.labels.push_back({{(box.min_x + box.max_x) / 2, (box.min_y + box.max_y) / 2},
                            std::min({kLetters, box.height() / 5, longest}),
                            piece.name,
                            /*is_name=*/true});
  }
  if (!options.grain_lines.empty()) {
    const Copies copies(flat, pattern.piece_of);
    for (const GrainLine& line : options.grain_lines) {
      const auto ends = EndsOf(line, flat, copies);
      if (!ends) continue;
      PatternPiece& piece = pattern.pieces[pattern.piece_of[ends->first]];
      piece.lines.push_back({LineKind::kGrain,
                             /*closed=*/false,
                             {pattern.points[ends->first], pattern.points[ends->second]}});
    }
  }
  if (options.allowance > 0) CHECK_OK(AddAllowance(flat, options, cancel, pattern));
  if (options.notches) AddNotches(flat, options.allowance, pattern);
  if (options.sheet_width > 0) {
    CHECK_OK(PackRoll(options.sheet_width, pattern));
  } else if (options.allowance > 0) {
    SetApart(options.allowance, pattern);
  }
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
