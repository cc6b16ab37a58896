#include "core/flatten/sheet/overlap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/try.h"
#include "core/mesh/plane.h"

namespace arap {
namespace {

struct Segment {
  Complex from, to;
};

struct Box {
  Complex low, high;
  static Box Of(const Segment& s);
  void Include(const Box& other);
  bool Meets(const Box& other) const {
    return low.real() <= other.high.real() && other.low.real() <= high.real() &&
           low.imag() <= other.high.imag() && other.low.imag() <= high.imag();
  }
};

// A tree of bounding boxes over segments: which may cross which. Built in O(n log n).
class SegmentTree {
 public:
  explicit SegmentTree(std::span<const Segment> segments);

  // Calls visit(other) for the segments of index above `index` whose boxes meet that of segment
  // `index`, in no order to rely on.
  template <class Visit>
  void VisitAfter(std::uint32_t index, Visit visit) const {
    if (nodes_.empty()) return;
    const Box& box = boxes_[index];
    std::uint32_t stack[64];  // halving keeps the tree far shallower than this
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t at = stack[--depth];
      const Node& node = nodes_[at];
      if (node.last <= index || !node.box.Meets(box)) continue;
      if (node.right != 0) {
        stack[depth++] = node.right;
        stack[depth++] = at + 1;
        continue;
      }
      for (std::uint32_t k = node.begin; k < node.end; ++k) {
        if (items_[k] > index && boxes_[items_[k]].Meets(box)) visit(items_[k]);
      }
    }
  }

 private:
  // Over items_[begin, end); the children of node i are i + 1 and `right`, none when right is 0.
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t right = 0;
    std::uint32_t last = 0;  // the highest index in it
  };
  std::uint32_t Build(std::uint32_t begin, std::uint32_t end);

  std::vector<Box> boxes_;            // by segment
  std::vector<std::uint32_t> items_;  // segment indices, node by node
  std::vector<Node> nodes_;
};

constexpr std::uint32_t kLeafSize = 4;

Box Box::Of(const Segment& s) {
  return {{std::min(s.from.real(), s.to.real()), std::min(s.from.imag(), s.to.imag())},
          {std::max(s.from.real(), s.to.real()), std::max(s.from.imag(), s.to.imag())}};
}

void Box::Include(const Box& other) {
  low = {std::min(low.real(), other.low.real()), std::min(low.imag(), other.low.imag())};
  high = {std::max(high.real(), other.high.real()), std::max(high.imag(), other.high.imag())};
}

SegmentTree::SegmentTree(std::span<const Segment> segments) : items_(segments.size()) {
  boxes_.reserve(segments.size());
  for (const Segment& s : segments) boxes_.push_back(Box::Of(s));
  std::iota(items_.begin(), items_.end(), 0u);
  if (!items_.empty()) Build(0, static_cast<std::uint32_t>(items_.size()));
}

std::uint32_t SegmentTree::Build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node{boxes_[items_[begin]], begin, end, 0, 0};
  for (std::uint32_t k = begin; k < end; ++k) {
    node.box.Include(boxes_[items_[k]]);
    node.last = std::max(node.last, items_[k]);
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) return index;
  const Complex extent = node.box.high - node.box.low;
  const bool wide = extent.real() >= extent.imag();
  // Twice the centre along the longer side; the index decides between equals.
  const auto key = [&](std::uint32_t s) {
    const Complex sum = boxes_[s].low + boxes_[s].high;
    return std::make_pair(wide ? sum.real() : sum.imag(), s);
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  Build(begin, middle);
  const std::uint32_t right = Build(middle, end);
  nodes_[index].right = right;
  return index;
}

constexpr double kGoldenFraction = 0.6180339887498949;

// A loop drawn in, and where its segments are among all.
struct Outline {
  std::uint32_t loop;  // its index in the input
  std::uint32_t chart;
  std::uint32_t begin, end;  // segments
  Box box;
  bool hole;  // runs clockwise
};

// Which side of the segment p is on: positive on its left.
double SideOf(const Segment& s, Complex p) { return TwiceArea(s.from, s.to, p); }

// A point on the line always counts as left of it: a path through an end of a segment crosses once.
bool SegmentsCross(const Segment& a, const Segment& b) {
  return (SideOf(a, b.from) < 0) != (SideOf(a, b.to) < 0) &&
         (SideOf(b, a.from) < 0) != (SideOf(b, a.to) < 0);
}

Complex Unit(Complex z) {
  const double length = std::abs(z);
  return length > 0 ? z / length : Complex(0);
}

// All boundary segments, drawn in. Points that lie exactly on other segments would leave open what
// crosses what, so every vertex moves inward by a different length, 1 to 2 times `amount`.
class Boundary {
 public:
  Boundary(std::span<const Complex> uv, std::span<const BoundaryLoop> loops) {
    const double amount = kTouching * Diagonal(uv, loops);
    for (std::uint32_t l = 0; l < loops.size(); ++l) {
      if (loops[l].vertices.size() >= 3) Add(uv, loops[l], l, amount);
    }
  }

  const std::vector<Segment>& segments() const { return segments_; }
  const std::vector<Outline>& outlines() const { return outlines_; }
  const std::array<std::uint32_t, 2>& ends(std::uint32_t segment) const { return ends_[segment]; }

  bool Adjacent(std::uint32_t a, std::uint32_t b) const {
    return ends_[a][0] == ends_[b][0] || ends_[a][0] == ends_[b][1] || ends_[a][1] == ends_[b][0] ||
           ends_[a][1] == ends_[b][1];
  }

  // How often an outline goes round a point, counter-clockwise.
  int Winding(const Outline& outline, Complex p) const {
    int winding = 0;
    for (std::uint32_t k = outline.begin; k < outline.end; ++k) {
      const Segment& s = segments_[k];
      const bool from = s.from.imag() <= p.imag(), to = s.to.imag() <= p.imag();
      if (from && !to && SideOf(s, p) > 0) ++winding;
      if (!from && to && SideOf(s, p) < 0) --winding;
    }
    return winding;
  }

 private:
  static double Diagonal(std::span<const Complex> uv, std::span<const BoundaryLoop> loops) {
    bool any = false;
    Box box{};
    for (const BoundaryLoop& loop : loops) {
      for (const std::uint32_t v : loop.vertices) {
        const Box point{uv[v], uv[v]};
        if (!any) box = point;
        any = true;
        box.Include(point);
      }
    }
    return std::abs(box.high - box.low);
  }

  void Add(std::span<const Complex> uv, const BoundaryLoop& loop, std::uint32_t index,
           double amount) {
    const std::vector<std::uint32_t>& v = loop.vertices;
    const std::size_t n = v.size();
    std::vector<Complex> drawn(n);
    double area = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const Complex at = uv[v[k]], before = uv[v[(k + n - 1) % n]], after = uv[v[(k + 1) % n]];
      const double fraction = std::fmod(kGoldenFraction * static_cast<double>(++points_), 1.0);
      // To the left of both segments. At the tip of a spike or a slit left has no meaning: it
      // stays.
      const Complex inward = Unit(Complex(0, 1) * (Unit(at - before) + Unit(after - at)));
      drawn[k] = at + amount * (1 + fraction) * inward;
      area += Cross(at - uv[v[0]], after - uv[v[0]]);
    }
    const auto begin = static_cast<std::uint32_t>(segments_.size());
    Outline outline{index, loop.component, begin, begin, {drawn[0], drawn[0]}, area < 0};
    for (std::size_t k = 0; k < n; ++k) {
      segments_.push_back({drawn[k], drawn[(k + 1) % n]});
      ends_.push_back({v[k], v[(k + 1) % n]});
      outline.box.Include(Box::Of(segments_.back()));
    }
    outline.end = static_cast<std::uint32_t>(segments_.size());
    outlines_.push_back(outline);
  }

  std::size_t points_ = 0;
  std::vector<Segment> segments_;
  std::vector<std::array<std::uint32_t, 2>> ends_;  // vertices, by segment
  std::vector<Outline> outlines_;
};

// How often `cancel` is asked.
constexpr std::uint32_t kAskEvery = 256;

Status CountCrossings(const Boundary& boundary, const CancelToken& cancel, Overlap& overlap) {
  const std::vector<Segment>& segments = boundary.segments();
  const SegmentTree tree(segments);
  std::vector<std::uint32_t> crossed;
  for (std::uint32_t a = 0; a < segments.size() && overlap.crossings < kMaxCrossings; ++a) {
    if (a % kAskEvery == 0) {
      CHECK_OK(cancel.Check());
    }
    crossed.clear();
    tree.VisitAfter(a, [&](std::uint32_t b) {
      if (SegmentsCross(segments[a], segments[b]) && !boundary.Adjacent(a, b)) crossed.push_back(b);
    });
    if (crossed.empty()) continue;
    if (overlap.crossings == 0) {
      const auto& first = boundary.ends(a);
      const auto& second = boundary.ends(*std::min_element(crossed.begin(), crossed.end()));
      overlap.first_crossing = {first[0], first[1], second[0], second[1]};
    }
    overlap.crossings = std::min(kMaxCrossings, overlap.crossings + crossed.size());
  }
  return {};
}

// Adds up how often other loops wind around a point of each loop. It must be 0 for the loops of
// every other chart, and for those of its own chart 0 for an outline and 1 for a hole. (Loops that
// cross are known to overlap already.)
Status CountMisplaced(const Boundary& boundary, const CancelToken& cancel, Overlap& overlap) {
  for (const Outline& loop : boundary.outlines()) {
    if (loop.loop % kAskEvery == 0) {
      CHECK_OK(cancel.Check());
    }
    const Complex point = boundary.segments()[loop.begin].from;
    const Box box{point, point};
    int own = 0;
    std::vector<std::pair<std::uint32_t, int>> charts;
    for (const Outline& other : boundary.outlines()) {
      if (other.loop == loop.loop || !other.box.Meets(box)) continue;
      const int winding = boundary.Winding(other, point);
      if (other.chart == loop.chart) {
        own += winding;
      } else if (winding != 0) {
        charts.emplace_back(other.chart, winding);
      }
    }
    bool misplaced = own != (loop.hole ? 1 : 0);
    std::sort(charts.begin(), charts.end());
    for (std::size_t k = 0; k < charts.size();) {
      const std::uint32_t chart = charts[k].first;
      int sum = 0;
      for (; k < charts.size() && charts[k].first == chart; ++k) sum += charts[k].second;
      misplaced = misplaced || sum != 0;
    }
    if (!misplaced) continue;
    if (overlap.misplaced_loops++ == 0) overlap.first_misplaced = loop.loop;
  }
  return {};
}

}  // namespace

Result<Overlap> FindOverlap(std::span<const Complex> uv, std::span<const BoundaryLoop> loops,
                            const CancelToken& cancel) {
  const Boundary boundary(uv, loops);
  Overlap overlap;
  CHECK_OK(CountCrossings(boundary, cancel, overlap));
  CHECK_OK(CountMisplaced(boundary, cancel, overlap));
  return overlap;
}

}  // namespace arap
