#include "core/drawing/allowance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <clipper.hpp>

#include "core/base/plane.h"
#include "core/base/try.h"

namespace arap {
namespace {

using ClipperLib::Path;
using ClipperLib::Paths;

// How far the tip of a mitred corner may be from it, in widths.
constexpr double kMiterLimit = 2;
// The same for the way back from the border to the outline, which tells what was lost.
constexpr double kHollowLimit = 3;
constexpr double kTolerance = 0.1;  // of what was lost, in widths

// Where curves become whole numbers, so that uniting them is exact, and lie so that the sweep of
// Clipper, along y, meets few edges at a time.
class Canvas {
 public:
  Canvas(const std::vector<Ring>& rings, double reach) {
    double largest = 0, across = 0, up = 0;
    for (const Ring& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Complex p = ring[i], along = ring[(i + 1) % ring.size()] - p;
        largest = std::max({largest, std::abs(p.real()), std::abs(p.imag())});
        across += std::abs(along.real());
        up += std::abs(along.imag());
      }
    }
    // Decimal, so that numbers of few digits stay what they are. Clipper is fast below 2^30.
    constexpr double kRange = 1 << 29;
    scale_ = std::pow(10, std::floor(std::log10(kRange / (largest + reach))));
    if (up > across) turn_ = Complex(0, 1);
  }

  Complex turn() const { return turn_; }

  // Without points that fall on the one before.
  Path In(const Ring& ring) const {
    Path path;
    for (const Complex p : ring) {
      const Complex turned = scale_ * turn_ * p;
      const ClipperLib::IntPoint point(std::llround(turned.real()), std::llround(turned.imag()));
      if (path.empty() || path.back() != point) path.push_back(point);
    }
    while (path.size() > 1 && path.front() == path.back()) path.pop_back();
    return path;
  }
  Paths In(const std::vector<Ring>& rings) const {
    Paths paths;
    for (const Ring& ring : rings) paths.push_back(In(ring));
    return paths;
  }

  Ring Out(const Path& path) const {
    Ring ring;
    for (const ClipperLib::IntPoint p : path) {
      const Complex turned(static_cast<double>(p.X), static_cast<double>(p.Y));
      // Quotients of whole numbers are the nearest to the decimal; products are not. 0 has no sign.
      const Complex back = std::conj(turn_) * turned;
      ring.emplace_back(back.real() / scale_ + 0.0, back.imag() / scale_ + 0.0);
    }
    return ring;
  }
  std::vector<Ring> Out(const Paths& paths) const {
    std::vector<Ring> rings;
    for (const Path& path : paths) rings.push_back(Out(path));
    return rings;
  }

 private:
  double scale_ = 1;
  Complex turn_ = 1;
};

// The borders of everything that the curves go round as often as `rule` wants, which is on the left
// of them.
Paths United(const Paths& curves, ClipperLib::PolyFillType rule) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(curves, ClipperLib::ptSubject, /*Closed=*/true);
  Paths borders;
  clipper.Execute(ClipperLib::ctUnion, borders, rule, rule);
  return borders;
}

// The length of the curves inside a region.
double LengthInside(const std::vector<Ring>& curves, const Paths& region, const Canvas& canvas) {
  ClipperLib::Clipper clipper;
  for (const Ring& curve : curves) {
    Path path = canvas.In(curve);
    if (path.size() < 2) continue;
    path.push_back(path.front());
    clipper.AddPath(path, ClipperLib::ptSubject, /*Closed=*/false);
  }
  clipper.AddPaths(region, ClipperLib::ptClip, /*Closed=*/true);
  ClipperLib::PolyTree tree;
  clipper.Execute(ClipperLib::ctIntersection, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  Paths inside;
  ClipperLib::OpenPathsFromPolyTree(tree, inside);
  double length = 0;
  for (const Path& path : inside) {
    const Ring line = canvas.Out(path);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) length += std::abs(line[i + 1] - line[i]);
  }
  return length;
}

// Goes round the outside of corners at a distance.
class Pen {
 public:
  Pen(double width, Corners corners, double limit)
      : width_(width), corners_(corners), limit_(corners == Corners::kSquare ? 1 : limit) {
    const double miss = std::max(0.01, 1e-3 * width) / width;
    arc_ = 2 * std::acos(1 - std::min(miss, 0.5));
  }

  // The curve moved to its right. What it goes round at least once is the piece and its allowance.
  // Where it bends inwards its sides meet; where they are too short for that it comes back to the
  // corner, and the little loops that this makes count for nothing.
  Ring Moved(const Ring& curve) const {
    const std::size_t n = curve.size();
    std::vector<Complex> along(n);  // of the side after each corner
    std::vector<double> length(n), shorter(n);
    for (std::size_t i = 0; i < n; ++i) {
      along[i] = curve[(i + 1) % n] - curve[i];
      length[i] = std::abs(along[i]);
      along[i] /= length[i];
    }
    // What bending inwards takes from both sides of a corner.
    for (std::size_t i = 0; i < n; ++i) {
      const Complex in = along[(i + n - 1) % n], out = along[i];
      if (!TurnsLeft(in, out)) shorter[i] = -width_ * Cross(in, out) / (1 + Dot(in, out));
    }
    const auto remains = [&](std::size_t i) {
      return length[i % n] > shorter[i % n] + shorter[(i + 1) % n];
    };
    Ring moved;
    for (std::size_t i = 0; i < n; ++i) {
      const Complex at = curve[i], in = along[(i + n - 1) % n], out = along[i];
      const Complex right(0, -1);
      if (TurnsLeft(in, out)) {
        AppendCorner(at, in, out, moved);
      } else if (remains(i + n - 1) && remains(i)) {
        moved.push_back(at + width_ * in * right - shorter[i] * in);
      } else {
        moved.insert(moved.end(), {at + width_ * in * right, at, at + width_ * out * right});
      }
    }
    return moved;
  }

  std::vector<Ring> Moved(const std::vector<Ring>& curves) const {
    std::vector<Ring> moved;
    moved.reserve(curves.size());
    for (const Ring& curve : curves) moved.push_back(Moved(curve));
    return moved;
  }

 private:
  // A turn straight back is one to the left, whatever rounding makes of it.
  static bool TurnsLeft(Complex in, Complex out) {
    return Cross(in, out) > 0 || (Dot(in, out) < 0 && std::abs(Cross(in, out)) < 1e-9);
  }

  // The corner at `at`, between edges along the unit vectors `in` and `out`.
  void AppendCorner(Complex at, Complex in, Complex out, Ring& curve) const {
    const Complex right(0, -1);
    const Complex first = in * right, second = out * right;
    curve.push_back(at + width_ * first);
    const double cosine =
        std::sqrt(std::max(0.0, (1 + Dot(first, second)) / 2));  // of half the turn
    constexpr double kBlunt = 0.999;                             // the tip is as good as on the arc
    if (corners_ == Corners::kRound && cosine < kBlunt) {
      const double turn = 2 * std::acos(cosine);
      const double parts = std::ceil(turn / arc_);
      for (double k = 1; k < parts; ++k) {
        curve.push_back(at + width_ * first * std::polar(1.0, turn * k / parts));
      }
    } else if (limit_ * cosine >= 1 || cosine >= kBlunt) {
      curve.push_back(at + width_ / (2 * cosine * cosine) * (first + second));
    } else {
      const double sine = std::sqrt(1 - cosine * cosine);
      const double along = width_ * (limit_ - cosine) / sine;
      curve.push_back(at + width_ * first + along * in);
      curve.push_back(at + width_ * second - along * out);
    }
    curve.push_back(at + width_ * second);
  }

  double width_;
  Corners corners_;
  double limit_;
  double arc_;  // radians between points of an arc
};

// An edge with its extent along the y axis.
struct Edge {
  Complex a, b;
  double low, high;

  Edge(Complex from, Complex to)
      : a(from), b(to), low(std::min(a.imag(), b.imag())), high(std::max(a.imag(), b.imag())) {}

  bool Crosses(const Edge& other) const {
    const auto parted = [](const Edge& line, const Edge& ends) {
      const Complex along = line.b - line.a;
      return Cross(along, ends.a - line.a) * Cross(along, ends.b - line.a) < 0;
    };
    return parted(*this, other) && parted(other, *this);
  }
};

// Takes from `left` what it costs to unite the curves.
Status Afford(const std::vector<Ring>& curves, const Canvas& canvas, std::size_t& left) {
  constexpr std::size_t kCrossing = 1000;
  std::vector<Edge> edges;
  for (const Ring& curve : curves) {
    for (std::size_t i = 0; i < curve.size(); ++i) {
      edges.emplace_back(canvas.turn() * curve[i], canvas.turn() * curve[(i + 1) % curve.size()]);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low < b.low; });
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    for (auto other = edge + 1; other != edges.end() && other->low <= edge->high; ++other) {
      const std::size_t cost = edge->Crosses(*other) ? kCrossing : 1;
      if (cost > left) {
        return Fail(Fault(FaultKind::kInvalidOption,
                          "An outline crosses itself too often, or winds too narrowly for the "
                          "width, to have a seam allowance.")
                        .Field("allowance"));
      }
      left -= cost;
    }
  }
  return {};
}

// Back from the border to the outline and a little farther is a region that only lost parts of the
// outline are in.
std::optional<double> Lost(const std::vector<Ring>& rings, const Paths& piece, double width,
                           const Canvas& canvas, std::size_t& left) {
  // Mitred, whatever the corners are: arcs would become bends that are narrower than the way back.
  const Pen pen(width, Corners::kMitre, kMiterLimit);
  std::vector<Ring> border =
      canvas.Out(United(canvas.In(pen.Moved(canvas.Out(piece))), ClipperLib::pftNonZero));
  for (Ring& ring : border) std::reverse(ring.begin(), ring.end());
  const Pen back((1 + kTolerance) * width, Corners::kMitre, kHollowLimit);
  const std::vector<Ring> inside = back.Moved(border);
  if (!Afford(inside, canvas, left)) return std::nullopt;
  // What is outside or beside the border is gone round as often as not, or more; the region once
  // less.
  return LengthInside(rings, United(canvas.In(inside), ClipperLib::pftNegative), canvas);
}

Result<Allowance> Offset(const std::vector<Ring>& rings, double width, Corners corners,
                         BorderBudget& budget) {
  const Canvas canvas(rings, (kMiterLimit + kHollowLimit) * width);
  CHECK_OK(Afford(rings, canvas, budget.left));
  const Paths piece = United(canvas.In(rings), ClipperLib::pftNonZero);
  const Pen pen(width, corners, kMiterLimit);
  const std::vector<Ring> outside = pen.Moved(canvas.Out(piece));
  CHECK_OK(Afford(outside, canvas, budget.left));
  Allowance allowance;
  allowance.rings = canvas.Out(United(canvas.In(outside), ClipperLib::pftNonZero));

  allowance.lost = Lost(rings, piece, width, canvas, budget.left_to_check);
  for (Ring& ring : allowance.rings) {
    const auto farthest = std::max_element(ring.begin(), ring.end(), [](Complex a, Complex b) {
      return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
    });
    std::rotate(ring.begin(), farthest, ring.end());
  }
  return allowance;
}

}  // namespace

Result<Allowance> OffsetOutwards(const std::vector<Ring>& rings, double width, Corners corners,
                                 BorderBudget& budget) {
  try {
    return Offset(rings, width, corners, budget);
  } catch (const ClipperLib::clipperException& error) {
    return Fail(Fault(FaultKind::kInvalidOption, "The outline cannot have a seam allowance.")
                    .Field("allowance")
                    .Detail("cause", error.what()));
  }
}

}  // namespace arap
