#include "core/drawing/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <boost/polygon/polygon.hpp>

#include "core/base/plane.h"

namespace arap {
namespace {

using IntegerPoint = boost::polygon::point_data<int>;
using Region = boost::polygon::polygon_set_data<int>;
using Piece = boost::polygon::polygon_with_holes_data<int>;

constexpr double kMiterLimit = 2;  // of a corner, in widths

// Regions are made of whole numbers, so that uniting them is exact.
class Canvas {
 public:
  Canvas(const std::vector<Ring>& rings, double width) {
    double largest = 0;
    for (const Ring& ring : rings) {
      for (const Complex p : ring) {
        largest = std::max({largest, std::abs(p.real()), std::abs(p.imag())});
      }
    }
    constexpr double kRange = 1 << 29;
    step_ = std::max(1e-3, (largest + (kMiterLimit + 1) * width) / kRange);
  }

  // Adds one to how often the curve goes round what is on its left, and takes one from what is on
  // its right.
  void Add(const std::vector<Complex>& curve) {
    std::vector<IntegerPoint> points;
    for (const Complex p : curve) {
      const IntegerPoint point(static_cast<int>(std::lround(p.real() / step_)),
                               static_cast<int>(std::lround(p.imag() / step_)));
      if (points.empty() || points.back() != point) points.push_back(point);
    }
    region_.insert_vertex_sequence(points.begin(), points.end(), boost::polygon::COUNTERCLOCKWISE,
                                   /*is_hole=*/false);
  }

  std::vector<Ring> Borders() const {
    std::vector<Piece> pieces;
    region_.get(pieces);
    std::vector<Ring> rings;
    for (const Piece& piece : pieces) {
      rings.push_back(ToRing(piece.begin(), piece.end()));
      for (auto hole = piece.begin_holes(); hole != piece.end_holes(); ++hole) {
        rings.push_back(ToRing(hole->begin(), hole->end()));
      }
    }
    return rings;
  }

 private:
  // Without the points that lie straight between their neighbours; Boost repeats the first.
  template <class Iterator>
  Ring ToRing(Iterator begin, Iterator end) const {
    std::vector<IntegerPoint> points(begin, end);
    if (points.size() > 1 && points.front() == points.back()) points.pop_back();
    const std::size_t n = points.size();
    Ring ring;
    for (std::size_t i = 0; i < n; ++i) {
      const IntegerPoint before = points[(i + n - 1) % n], at = points[i],
                         after = points[(i + 1) % n];
      const auto cross = [&] {
        return (std::int64_t{at.x()} - before.x()) * (std::int64_t{after.y()} - at.y()) -
               (std::int64_t{at.y()} - before.y()) * (std::int64_t{after.x()} - at.x());
      };
      if (cross() != 0) ring.emplace_back(step_ * at.x(), step_ * at.y());
    }
    return ring;
  }

  double step_;
  Region region_;
};

std::vector<Complex> PointsOf(const Ring& ring) {
  std::vector<Complex> points;
  for (const Complex p : ring) {
    if (points.empty() || points.back() != p) points.push_back(p);
  }
  while (points.size() > 1 && points.front() == points.back()) points.pop_back();
  return points;
}

// Goes round the outside of the corner at `at`, between edges along the unit vectors `in` and `out`.
void AppendCorner(Complex at, Complex in, Complex out, double width, std::vector<Complex>& curve) {
  const Complex right(0, -1);
  const Complex first = in * right, second = out * right;
  curve.push_back(at + width * first);
  const double cosine = std::sqrt(std::max(0.0, (1 + Dot(first, second)) / 2));  // of half the turn
  if (kMiterLimit * cosine >= 1) {
    curve.push_back(at + width / (2 * cosine * cosine) * (first + second));
  } else {
    const double sine = std::sqrt(1 - cosine * cosine);
    const double along = width * (kMiterLimit - cosine) / sine;
    curve.push_back(at + width * first + along * in);
    curve.push_back(at + width * second - along * out);
  }
  curve.push_back(at + width * second);
}

// The curve moved to its right. What it goes round at least once is the piece and its allowance;
// where it bends inwards it comes back to the corner, and those little loops count for nothing.
std::vector<Complex> Moved(const std::vector<Complex>& curve, double width) {
  std::vector<Complex> moved;
  const std::size_t n = curve.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Complex a = curve[i], b = curve[(i + 1) % n], c = curve[(i + 2) % n];
    const Complex in = (b - a) / std::abs(b - a), out = (c - b) / std::abs(c - b);
    // A turn straight back is one to the left, whatever rounding makes of it.
    const bool back = Dot(in, out) < 0 && std::abs(Cross(in, out)) < 1e-9;
    if (Cross(in, out) > 0 || back) {
      AppendCorner(b, in, out, width, moved);
    } else {
      const Complex right(0, -1);
      moved.insert(moved.end(), {b + width * in * right, b, b + width * out * right});
    }
  }
  return moved;
}

// An edge with its extent along the x axis.
struct Edge {
  Complex a, b;
  double low, high;

  Edge(Complex from, Complex to)
      : a(from), b(to), low(std::min(a.real(), b.real())), high(std::max(a.real(), b.real())) {}

  bool Crosses(const Edge& other) const {
    const auto parted = [](const Edge& line, const Edge& ends) {
      const Complex along = line.b - line.a;
      return Cross(along, ends.a - line.a) * Cross(along, ends.b - line.a) < 0;
    };
    return parted(*this, other) && parted(other, *this);
  }
};

// Takes from `left` what it costs to unite the curves; false when there is not enough.
bool Afford(const std::vector<std::vector<Complex>>& curves, std::size_t& left) {
  constexpr std::size_t kCrossing = 1000;
  double across = 0, up = 0;
  for (const auto& curve : curves) {
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const Complex along = curve[(i + 1) % curve.size()] - curve[i];
      across += std::abs(along.real());
      up += std::abs(along.imag());
    }
  }
  // Along the axis on which the edges are shorter fewer pairs overlap.
  const Complex turn = across > up ? Complex(0, 1) : 1;
  std::vector<Edge> edges;
  for (const auto& curve : curves) {
    for (std::size_t i = 0; i < curve.size(); ++i) {
      edges.emplace_back(turn * curve[i], turn * curve[(i + 1) % curve.size()]);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low < b.low; });
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    for (auto other = edge + 1; other != edges.end() && other->low <= edge->high; ++other) {
      const std::size_t cost = edge->Crosses(*other) ? kCrossing : 1;
      if (cost > left) return false;
      left -= cost;
    }
  }
  return true;
}

}  // namespace

void Bounds::Add(Complex point) {
  const double x = point.real(), y = point.imag();
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  if (empty) {
    *this = {x, y, x, y, false};
    return;
  }
  min_x = std::min(min_x, x);
  min_y = std::min(min_y, y);
  max_x = std::max(max_x, x);
  max_y = std::max(max_y, y);
}

void Bounds::Add(std::span<const Complex> points) {
  for (const Complex point : points) Add(point);
}

Bounds Bounds::Moved(Complex by) const {
  if (empty) return *this;
  return {min_x + by.real(), min_y + by.imag(), max_x + by.real(), max_y + by.imag(), false};
}

Result<std::vector<Ring>> OffsetOutwards(const std::vector<Ring>& rings, double width,
                                         BorderBudget& budget) {
  std::vector<std::vector<Complex>> curves;
  for (const Ring& ring : rings) {
    if (const std::vector<Complex> points = PointsOf(ring); points.size() > 2) {
      curves.push_back(Moved(points, width));
    }
  }
  if (!Afford(curves, budget.left)) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      "An outline crosses itself too often, or winds too narrowly for the width, "
                      "to have a seam allowance.")
                    .Field("allowance"));
  }
  Canvas canvas(rings, width);
  for (const auto& curve : curves) canvas.Add(curve);
  return canvas.Borders();
}

}  // namespace arap
