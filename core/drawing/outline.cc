#include "core/drawing/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <boost/polygon/polygon.hpp>

namespace arap {
namespace {

using IntegerPoint = boost::polygon::point_data<int>;
using Region = boost::polygon::polygon_set_data<int>;
using Piece = boost::polygon::polygon_with_holes_data<int>;

constexpr double kMiterLimit = 2;  // of a corner, in widths

double Dot(Complex a, Complex b) { return (std::conj(a) * b).real(); }
double Cross(Complex a, Complex b) { return (std::conj(a) * b).imag(); }

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

  void Add(const std::vector<Complex>& polygon, bool hole = false) {
    std::vector<IntegerPoint> points;
    for (const Complex p : polygon) {
      const IntegerPoint point(static_cast<int>(std::lround(p.real() / step_)),
                               static_cast<int>(std::lround(p.imag() / step_)));
      if (points.empty() || points.back() != point) points.push_back(point);
    }
    boost::polygon::polygon_data<int> data;
    data.set(points.begin(), points.end());
    region_.insert(data, hole);
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

double SignedArea(const std::vector<Complex>& points) {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    twice += Cross(points[i] - points[0], points[(i + 1) % points.size()] - points[0]);
  }
  return twice / 2;
}

// The outside of the corner at `at`, between edges along the unit vectors `in` and `out`.
std::vector<Complex> Corner(Complex at, Complex in, Complex out, double width) {
  const Complex right(0, -1);
  const Complex first = in * right, second = out * right;
  std::vector<Complex> corner{at, at + width * first};
  const double cosine = std::sqrt(std::max(0.0, (1 + Dot(first, second)) / 2));  // of half the turn
  if (kMiterLimit * cosine >= 1) {
    corner.push_back(at + width / (2 * cosine * cosine) * (first + second));
  } else {
    const double sine = std::sqrt(1 - cosine * cosine);
    const double along = width * (kMiterLimit - cosine) / sine;
    corner.push_back(at + width * first + along * in);
    corner.push_back(at + width * second - along * out);
  }
  corner.push_back(at + width * second);
  return corner;
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

std::vector<Ring> OffsetOutwards(const std::vector<Ring>& rings, double width) {
  Canvas canvas(rings, width);
  std::vector<std::vector<Complex>> curves;
  for (const Ring& ring : rings) {
    if (std::vector<Complex> points = PointsOf(ring); points.size() > 2) {
      curves.push_back(std::move(points));
    }
  }
  for (const auto& curve : curves) canvas.Add(curve, /*hole=*/SignedArea(curve) < 0);
  for (const auto& curve : curves) {
    const std::size_t n = curve.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Complex a = curve[i], b = curve[(i + 1) % n], c = curve[(i + 2) % n];
      const Complex in = (b - a) / std::abs(b - a), out = (c - b) / std::abs(c - b);
      const Complex aside = width * in * Complex(0, -1);
      canvas.Add({a, a + aside, b + aside, b});
      if (Cross(in, out) > 0 || Dot(in, out) < 0) canvas.Add(Corner(b, in, out, width));
    }
  }
  return canvas.Borders();
}

}  // namespace arap
