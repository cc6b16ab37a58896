#include "client/cli/sample/field.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/outline/outline.h"
#include "core/outline/quality_mesh.h"

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

namespace {

// By central differences over `step`.
Point Gradient(const Field& field, Point p, double step) {
  const Point dx(step, 0);
  const Point dy(0, step);
  return {(field(p + dx) - field(p - dx)) / (2 * step),
          (field(p + dy) - field(p - dy)) / (2 * step)};
}

// Moves `p` along the gradient to the outline.
Point Project(const Field& field, Point p, double step) {
  constexpr int kNewtonSteps = 6;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Point gradient = Gradient(field, p, step);
    if (std::norm(gradient) == 0) break;
    p -= field(p) / std::norm(gradient) * gradient;
  }
  return p;
}

// Follows the outline in steps much finer than the sampling, until it closes.
std::vector<Point> Trace(const Field& field, Point start, double step) {
  constexpr std::size_t kMostSteps = 1'000'000;
  std::vector<Point> fine{start};
  while (fine.size() < kMostSteps) {
    const Point here = fine.back();
    const Point gradient = Gradient(field, here, step * 0.1);
    // The gradient points outwards; a quarter turn to the left of it runs counter-clockwise.
    const Point forward = Point(0, 1) * gradient / std::abs(gradient);
    fine.push_back(Project(field, here + step * forward, step * 0.1));
    if (fine.size() > 4 && std::abs(fine.back() - start) < 0.75 * step) break;
  }
  fine.back() = start;
  return fine;
}

// The closed outline through `start` (which is moved onto it), counter-clockwise, as evenly spaced
// points about `edge` apart. The outline has to be smooth over that length.
Outline SampleOutline(const Field& field, Point start, double edge) {
  const double step = edge / 16;
  const std::vector<Point> fine = Trace(field, Project(field, start, step * 0.1), step);
  double length = 0;
  for (std::size_t i = 1; i < fine.size(); ++i) length += std::abs(fine[i] - fine[i - 1]);

  // An even number keeps a symmetric outline symmetric when `start` lies on its axis.
  const auto count = 2 * static_cast<std::size_t>(std::lround(length / edge / 2));
  const double spacing = length / static_cast<double>(count);
  Outline samples;
  double walked = 0;
  for (std::size_t i = 1; i < fine.size() && samples.size() < count; ++i) {
    const double piece = std::abs(fine[i] - fine[i - 1]);
    for (double next = static_cast<double>(samples.size()) * spacing;
         next < walked + piece && samples.size() < count;
         next = static_cast<double>(samples.size()) * spacing) {
      const double along = (next - walked) / piece;
      const Point chord = fine[i - 1] + along * (fine[i] - fine[i - 1]);
      samples.push_back(Project(field, chord, step * 0.1));
    }
    walked += piece;
  }
  return samples;
}

}  // namespace

PlanarMesh MeshField(const Field& field, Point start, double edge) {
  const Outline outline = SampleOutline(field, start, edge);
  // A vertex takes two equilateral triangles. The outline of a field does not cross itself, so that
  // nothing can be wrong with it.
  const double vertices = 2 * SignedArea(outline) / (std::numbers::sqrt3 * edge * edge);
  const std::vector<Outline> outlines{outline};
  return MeshOutlines(outlines, static_cast<std::size_t>(std::lround(vertices))).value().mesh;
}

}  // namespace arap::cli
