#include "core/files/polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/plane.h"

namespace arap {
namespace {

// What counts as no height, as a part of the size of the polygon; and as no sine of an angle.
constexpr double kFlat = 1e-9;
// How often the ears are looked for all over again.
constexpr int kMostSearches = 8;

Point3 Minus(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point3 CrossOf(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double DotOf(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double LengthOf(const Point3& a) { return std::sqrt(DotOf(a, a)); }
double Largest(const Point3& a) {
  return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

// The polygon moved to its first corner and scaled to a size of about 1, so that nothing overflows,
// and turned into the plane that its area vector is normal to.
class FlatPolygon {
 public:
  FlatPolygon(std::span<const Point3> vertices, std::span<const std::uint32_t> corners)
      : vertices_(vertices), corners_(corners) {
    constexpr double kHuge = 1e150;  // its square is a double still
    double largest = 0;
    for (const std::uint32_t c : corners) largest = std::max(largest, Largest(vertices[c]));
    if (largest > kHuge) shrink_ = 1 / largest;
    double size = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) size = std::max(size, Largest(Moved(i)));
    if (size > 0) size_ = size;
    Point3 normal{};
    Point3 last{};
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const Point3 next = Scaled(i);
      const Point3 part = CrossOf(last, next);
      for (std::size_t k = 0; k < 3; ++k) normal[k] += part[k];
      last = next;
    }
    const double area = LengthOf(normal);
    if (!(area > kFlat * kFlat)) return;
    has_area_ = true;
    for (double& x : normal) x /= area;
    // Any direction across the normal: away from its largest coordinate.
    Point3 aside{};
    const bool along_x = std::abs(normal[0]) > 0.6;
    aside[along_x ? 1 : 0] = 1;
    u_ = CrossOf(aside, normal);
    const double length = LengthOf(u_);
    for (double& x : u_) x /= length;
    v_ = CrossOf(normal, u_);
  }

  bool has_area() const { return has_area_; }
  Complex At(std::size_t i) const {
    const Point3 p = Scaled(i);
    return {DotOf(p, u_), DotOf(p, v_)};
  }

 private:
  Point3 Moved(std::size_t i) const {
    Point3 p = vertices_[corners_[i]], origin = vertices_[corners_[0]];
    for (double& x : p) x *= shrink_;
    for (double& x : origin) x *= shrink_;
    return Minus(p, origin);
  }
  Point3 Scaled(std::size_t i) const {
    Point3 p = Moved(i);
    for (double& x : p) x /= size_;
    return p;
  }

  std::span<const Point3> vertices_;
  std::span<const std::uint32_t> corners_;
  double shrink_ = 1, size_ = 1;
  bool has_area_ = false;
  Point3 u_{}, v_{};
};

// Whether all triangles from the first corner turn left, and less than once around it.
bool IsFan(const FlatPolygon& polygon, std::size_t count) {
  double turned = 0;
  Complex last = polygon.At(1);
  for (std::size_t i = 2; i < count; ++i) {
    const Complex next = polygon.At(i);
    const double cross = Cross(last, next);
    if (!(cross > kFlat * std::abs(last) * std::abs(next))) return false;
    turned += std::atan2(cross, Dot(last, next));
    last = next;
  }
  return turned < 2 * std::numbers::pi;
}

// Ears are cut off one after the other, the best-shaped first.
class EarCutter {
 public:
  EarCutter(const FlatPolygon& polygon, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      corners_.push_back(i);
      points_.push_back(polygon.At(i));
    }
  }

  // The corners of the triangles; nothing when at some time no ear was left.
  std::optional<std::vector<std::array<std::size_t, 3>>> Cut() {
    std::vector<std::array<std::size_t, 3>> triangles;
    Search();
    for (int searches = 1; corners_.size() > 3;) {
      const auto best = std::max_element(shapes_.begin(), shapes_.end());
      if (*best <= 0) {
        if (++searches > kMostSearches) return std::nullopt;
        Search();
        if (*std::max_element(shapes_.begin(), shapes_.end()) <= 0) return std::nullopt;
        continue;
      }
      const auto i = static_cast<std::size_t>(best - shapes_.begin());
      triangles.push_back({corners_[Before(i)], corners_[i], corners_[After(i)]});
      corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(i));
      shapes_.erase(best);
      const std::size_t next = i == corners_.size() ? 0 : i;
      shapes_[Before(next)] = ShapeOf(Before(next));
      shapes_[next] = ShapeOf(next);
    }
    triangles.push_back({corners_[0], corners_[1], corners_[2]});
    return triangles;
  }

 private:
  std::size_t Before(std::size_t i) const { return i == 0 ? corners_.size() - 1 : i - 1; }
  std::size_t After(std::size_t i) const { return i + 1 == corners_.size() ? 0 : i + 1; }

  void Search() {
    shapes_.assign(corners_.size(), 0);
    for (std::size_t i = 0; i < corners_.size(); ++i) shapes_[i] = ShapeOf(i);
  }

  // How good a triangle the ear at this corner would be: above 0, and most for an equilateral one; 0
  // when there is no ear.
  double ShapeOf(std::size_t i) const {
    const Complex a = points_[corners_[Before(i)]], b = points_[corners_[i]],
                  c = points_[corners_[After(i)]];
    const double cross = TwiceArea(a, b, c);
    const double ab = std::abs(b - a), bc = std::abs(c - b), ca = std::abs(a - c);
    if (!(cross > kFlat * ab * bc)) return 0;
    // A corner at the place of one of the three is no obstacle: such polygons reach a hole by an
    // edge that they follow twice.
    for (const std::size_t corner : corners_) {
      const Complex p = points_[corner];
      if (p == a || p == b || p == c) continue;
      if (TwiceArea(a, b, p) > -kFlat * ab && TwiceArea(b, c, p) > -kFlat * bc &&
          TwiceArea(c, a, p) > -kFlat * ca) {
        return 0;
      }
    }
    return cross / (ab * ab + bc * bc + ca * ca);
  }

  std::vector<Complex> points_;       // of all corners
  std::vector<std::size_t> corners_;  // that are left
  std::vector<double> shapes_;        // of the ears at them, as far as is known
};

}  // namespace

PolygonCut CutPolygon(std::span<const Point3> vertices, std::span<const std::uint32_t> corners,
                      std::vector<Triangle>& triangles) {
  const auto append_fan = [&] {
    for (std::size_t i = 2; i < corners.size(); ++i) {
      triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  };
  if (corners.size() == 3) {
    append_fan();
    return PolygonCut::kFan;
  }
  const FlatPolygon polygon(vertices, corners);
  if (polygon.has_area() && IsFan(polygon, corners.size())) {
    append_fan();
    return PolygonCut::kFan;
  }
  if (polygon.has_area()) {
    if (corners.size() > kMaxConcaveCorners) return PolygonCut::kTooLong;
    if (const auto ears = EarCutter(polygon, corners.size()).Cut()) {
      for (const auto& [a, b, c] : *ears) {
        triangles.push_back({corners[a], corners[b], corners[c]});
      }
      return PolygonCut::kEars;
    }
  }
  append_fan();
  return PolygonCut::kUnclear;
}

}  // namespace arap
