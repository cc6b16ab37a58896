#include "client/cli/sample/field.h"

#include <algorithm>
#include <cmath>

namespace arap::cli {

double Disk(Point p, Point center, double radius) { return std::abs(p - center) - radius; }

double Capsule(Point p, Point a, Point b, double radius_a, double radius_b) {
  const Point axis = b - a;
  const double along = std::clamp((std::conj(axis) * (p - a)).real() / std::norm(axis), 0.0, 1.0);
  return std::abs(p - a - along * axis) - std::lerp(radius_a, radius_b, along);
}

double Ellipse(Point p, Point center, double radius_x, double radius_y) {
  const Point q = p - center;
  // Dividing by the gradient makes it a distance to first order at the outline.
  const Point unit(q.real() / radius_x, q.imag() / radius_y);
  const Point gradient(unit.real() / radius_x, unit.imag() / radius_y);
  const double length = std::abs(unit);
  const double steepness = std::abs(gradient);
  if (steepness == 0) return -std::min(radius_x, radius_y);
  return length * (length - 1) / steepness;
}

double SmoothUnion(double a, double b, double blend) {
  const double overlap = std::max(blend - std::abs(a - b), 0.0) / blend;
  return std::min(a, b) - overlap * overlap * blend / 4;
}

Point Gradient(const Field& field, Point p, double step) {
  const Point dx(step, 0);
  const Point dy(0, step);
  return {(field(p + dx) - field(p - dx)) / (2 * step),
          (field(p + dy) - field(p - dy)) / (2 * step)};
}

Point Project(const Field& field, Point p, double step) {
  constexpr int kNewtonSteps = 6;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Point gradient = Gradient(field, p, step);
    if (std::norm(gradient) == 0) break;
    p -= field(p) / std::norm(gradient) * gradient;
  }
  return p;
}

}  // namespace arap::cli
