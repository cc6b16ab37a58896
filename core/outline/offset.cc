#include "core/outline/offset.h"

#include <algorithm>
#include <cmath>

#include "core/base/plane.h"
#include "core/base/try.h"

namespace arap {

Canvas::Canvas(std::span<const Outline> outlines, double reach) {
  double largest = 0, across = 0, up = 0;
  for (const Outline& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Complex p = outline[i], along = outline[(i + 1) % outline.size()] - p;
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

Path Canvas::In(const Outline& outline) const {
  Path path;
  for (const Complex p : outline) {
    const Complex turned = scale_ * turn_ * p;
    const ClipperLib::IntPoint point(std::llround(turned.real()), std::llround(turned.imag()));
    if (path.empty() || path.back() != point) path.push_back(point);
  }
  while (path.size() > 1 && path.front() == path.back()) path.pop_back();
  return path;
}

Paths Canvas::In(std::span<const Outline> outlines) const {
  Paths paths;
  for (const Outline& outline : outlines) paths.push_back(In(outline));
  return paths;
}

Outline Canvas::Out(const Path& path) const {
  Outline outline;
  for (const ClipperLib::IntPoint p : path) {
    const Complex turned(static_cast<double>(p.X), static_cast<double>(p.Y));
    // Quotients of whole numbers are the nearest to the decimal; products are not. 0 has no sign.
    const Complex back = std::conj(turn_) * turned;
    outline.emplace_back(back.real() / scale_ + 0.0, back.imag() / scale_ + 0.0);
  }
  return outline;
}

std::vector<Outline> Canvas::Out(const Paths& paths) const {
  std::vector<Outline> outlines;
  for (const Path& path : paths) outlines.push_back(Out(path));
  return outlines;
}

Paths United(const Paths& curves, ClipperLib::PolyFillType rule) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(curves, ClipperLib::ptSubject, /*Closed=*/true);
  Paths borders;
  clipper.Execute(ClipperLib::ctUnion, borders, rule, rule);
  return borders;
}

namespace {

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

}  // namespace

Result<bool> CanAfford(std::span<const Outline> curves, const Canvas& canvas, std::size_t crossing,
                       std::size_t& left, const CancelToken& cancel) {
  constexpr std::size_t kPairsAtATime = 1'000'000;
  std::vector<Edge> edges;
  for (const Outline& curve : curves) {
    for (std::size_t i = 0; i < curve.size(); ++i) {
      edges.emplace_back(canvas.turn() * curve[i], canvas.turn() * curve[(i + 1) % curve.size()]);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low < b.low; });
  std::size_t pairs = 0;
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    for (auto other = edge + 1; other != edges.end() && other->low <= edge->high; ++other) {
      if (++pairs % kPairsAtATime == 0) CHECK_OK(cancel.Check());
      const std::size_t cost = edge->Crosses(*other) ? crossing : 1;
      if (cost > left) return false;
      left -= cost;
    }
  }
  return true;
}

Pen::Pen(double width, Corners corners, double limit, double miss)
    : width_(width),
      corners_(corners),
      limit_(corners == Corners::kSquare ? 1 : limit),
      arc_(2 * std::acos(1 - std::min(miss / width, 0.5))) {}

namespace {

// A turn straight back is one to the left, whatever rounding makes of it.
bool TurnsLeft(Complex in, Complex out) {
  return Cross(in, out) > 0 || (Dot(in, out) < 0 && std::abs(Cross(in, out)) < 1e-9);
}

}  // namespace

Outline Pen::Moved(const Outline& curve) const {
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
  Outline moved;
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

std::vector<Outline> Pen::Moved(std::span<const Outline> curves) const {
  std::vector<Outline> moved;
  moved.reserve(curves.size());
  for (const Outline& curve : curves) moved.push_back(Moved(curve));
  return moved;
}

// The corner at `at`, between edges along the unit vectors `in` and `out`.
void Pen::AppendCorner(Complex at, Complex in, Complex out, Outline& curve) const {
  const Complex right(0, -1);
  const Complex first = in * right, second = out * right;
  curve.push_back(at + width_ * first);
  const double cosine = std::sqrt(std::max(0.0, (1 + Dot(first, second)) / 2));  // of half the turn
  constexpr double kBlunt = 0.999;  // the tip is as good as on the arc
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

}  // namespace arap
