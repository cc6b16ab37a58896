#include "core/flatten/sheet/overlap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/plane.h"
#include "core/base/try.h"

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

// A tree over boxes: which meet which. Built in O(n log n).
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  // Calls visit(k) for the boxes of index `first` and above that meet `box`, in no order to rely
  // on.
  template <class Visit>
  void VisitFrom(std::uint32_t first, const Box& box, Visit visit) const {
    if (nodes_.empty()) return;
    std::uint32_t stack[64];  // halving keeps the tree far shallower than this
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t at = stack[--depth];
      const Node& node = nodes_[at];
      if (node.last < first || !node.box.Meets(box)) continue;
      if (node.right != 0) {
        stack[depth++] = node.right;
        stack[depth++] = at + 1;
        continue;
      }
      for (std::uint32_t k = node.begin; k < node.end; ++k) {
        if (items_[k] >= first && boxes_[items_[k]].Meets(box)) visit(items_[k]);
      }
    }
  }

  const Box& box(std::uint32_t index) const { return boxes_[index]; }

 private:
  // Over items_[begin, end); the children of node i are i + 1 and `right`, none when right is 0.
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t right = 0;
    std::uint32_t last = 0;  // the highest index in it
  };
  std::uint32_t Build(std::uint32_t begin, std::uint32_t end);

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> items_;  // indices of boxes, node by node
  std::vector<Node> nodes_;
};

constexpr std::uint32_t kLeafSize = 4;
constexpr std::uint32_t kShortArc = 8;

Box Box::Of(const Segment& s) {
  return {{std::min(s.from.real(), s.to.real()), std::min(s.from.imag(), s.to.imag())},
          {std::max(s.from.real(), s.to.real()), std::max(s.from.imag(), s.to.imag())}};
}

void Box::Include(const Box& other) {
  low = {std::min(low.real(), other.low.real()), std::min(low.imag(), other.low.imag())};
  high = {std::max(high.real(), other.high.real()), std::max(high.imag(), other.high.imag())};
}

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), items_(boxes_.size()) {
  std::iota(items_.begin(), items_.end(), 0u);
  if (!items_.empty()) Build(0, static_cast<std::uint32_t>(items_.size()));
}

std::uint32_t BoxTree::Build(std::uint32_t begin, std::uint32_t end) {
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
  std::uint32_t arc;         // the whole of it, among the arcs
  bool hole;                 // runs clockwise
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

  const Box& box(const Outline& outline) const { return arcs_[outline.arc].box; }

  // How often an outline goes round a point, counter-clockwise. O(log n) but for arcs whose
  // bounding boxes hold the point.
  int Winding(const Outline& outline, Complex p) const {
    return Crossings(outline.arc, outline.begin, outline.end, p);
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
    for (std::size_t k = 0; k < n; ++k) {
      segments_.push_back({drawn[k], drawn[(k + 1) % n]});
      ends_.push_back({v[k], v[(k + 1) % n]});
    }
    const auto end = static_cast<std::uint32_t>(segments_.size());
    outlines_.push_back({index, loop.component, begin, end, AddArc(begin, end), area < 0});
  }

  // Segments [begin, end) of one outline and a box around them. A long arc has its first half at the
  // next place and its second half at `second`.
  struct Arc {
    Box box;
    std::uint32_t second = 0;
  };

  static std::uint32_t Half(std::uint32_t begin, std::uint32_t end) {
    return begin + (end - begin) / 2;
  }

  std::uint32_t AddArc(std::uint32_t begin, std::uint32_t end) {
    const auto at = static_cast<std::uint32_t>(arcs_.size());
    arcs_.push_back({Box::Of(segments_[begin]), 0});
    if (end - begin <= kShortArc) {
      for (std::uint32_t k = begin; k < end; ++k) arcs_[at].box.Include(Box::Of(segments_[k]));
      return at;
    }
    AddArc(begin, Half(begin, end));
    const std::uint32_t second = AddArc(Half(begin, end), end);
    arcs_[at].second = second;
    arcs_[at].box.Include(arcs_[at + 1].box);
    arcs_[at].box.Include(arcs_[second].box);
    return at;
  }

  // How often the segments [begin, end), which are an arc, cross the ray from p to the right: those
  // that go up less those that go down. An arc that lies right of p as a whole crosses as the
  // straight way between its ends does.
  int Crossings(std::uint32_t arc, std::uint32_t begin, std::uint32_t end, Complex p) const {
    const auto below = [p](Complex z) { return z.imag() <= p.imag(); };
    const Box& box = arcs_[arc].box;
    if (!below(box.low) || below(box.high) || box.high.real() < p.real()) return 0;
    if (box.low.real() > p.real()) {
      return int{below(segments_[begin].from)} - int{below(segments_[end - 1].to)};
    }
    if (arcs_[arc].second != 0) {
      return Crossings(arc + 1, begin, Half(begin, end), p) +
             Crossings(arcs_[arc].second, Half(begin, end), end, p);
    }
    int crossings = 0;
    for (std::uint32_t k = begin; k < end; ++k) {
      const Segment& s = segments_[k];
      if (below(s.from) && !below(s.to) && SideOf(s, p) > 0) ++crossings;
      if (!below(s.from) && below(s.to) && SideOf(s, p) < 0) --crossings;
    }
    return crossings;
  }

  std::size_t points_ = 0;
  std::vector<Segment> segments_;
  std::vector<std::array<std::uint32_t, 2>> ends_;  // vertices, by segment
  std::vector<Arc> arcs_;
  std::vector<Outline> outlines_;
};

// Asks the caller once in so many visits of a box.
class Asker {
 public:
  explicit Asker(const CancelToken& cancel) : cancel_(cancel) {}

  Status Visited(std::size_t boxes) {
    visited_ += 1 + boxes;
    if (visited_ < kAskEvery) return {};
    visited_ = 0;
    return cancel_.Check();
  }

 private:
  static constexpr std::size_t kAskEvery = 1 << 14;

  const CancelToken& cancel_;
  std::size_t visited_ = 0;
};

Status CountCrossings(const Boundary& boundary, const CancelToken& cancel, Overlap& overlap) {
  const std::vector<Segment>& segments = boundary.segments();
  std::vector<Box> boxes;
  boxes.reserve(segments.size());
  for (const Segment& s : segments) boxes.push_back(Box::Of(s));
  const BoxTree tree(std::move(boxes));
  Asker asker(cancel);
  std::vector<std::uint32_t> crossed;
  for (std::uint32_t a = 0; a < segments.size() && overlap.crossings < kMaxCrossings; ++a) {
    crossed.clear();
    std::size_t met = 0;
    tree.VisitFrom(a + 1, tree.box(a), [&](std::uint32_t b) {
      ++met;
      if (SegmentsCross(segments[a], segments[b]) && !boundary.Adjacent(a, b)) crossed.push_back(b);
    });
    CHECK_OK(asker.Visited(met));
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
  std::vector<Box> boxes;
  boxes.reserve(boundary.outlines().size());
  for (const Outline& loop : boundary.outlines()) boxes.push_back(boundary.box(loop));
  const BoxTree tree(std::move(boxes));
  Asker asker(cancel);
  std::vector<std::pair<std::uint32_t, int>> charts;
  for (const Outline& loop : boundary.outlines()) {
    const Complex point = boundary.segments()[loop.begin].from;
    int own = 0;
    std::size_t met = 0;
    charts.clear();
    tree.VisitFrom(0, {point, point}, [&](std::uint32_t index) {
      const Outline& other = boundary.outlines()[index];
      ++met;
      if (other.loop == loop.loop) return;
      const int winding = boundary.Winding(other, point);
      if (other.chart == loop.chart) {
        own += winding;
      } else if (winding != 0) {
        charts.emplace_back(other.chart, winding);
      }
    });
    CHECK_OK(asker.Visited(met));
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
