#include "client/cli/sample/field.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <boost/polygon/voronoi.hpp>

#include "core/base/plane.h"

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
std::vector<Point> SampleOutline(const Field& field, Point start, double edge) {
  const double step = edge / 16;
  const std::vector<Point> fine = Trace(field, Project(field, start, step * 0.1), step);
  double length = 0;
  for (std::size_t i = 1; i < fine.size(); ++i) length += std::abs(fine[i] - fine[i - 1]);

  // An even number keeps a symmetric outline symmetric when `start` lies on its axis.
  const auto count = 2 * static_cast<std::size_t>(std::lround(length / edge / 2));
  const double spacing = length / static_cast<double>(count);
  std::vector<Point> samples;
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

using IntegerPoint = boost::polygon::point_data<int>;

// The Voronoi builder is exact on 32-bit integers: the coordinates are spread over 2^30 steps.
std::vector<IntegerPoint> ToGrid(std::span<const Point> points) {
  double largest = 0;
  for (const Point p : points) {
    largest = std::max({largest, std::abs(p.real()), std::abs(p.imag())});
  }
  const double scale = largest > 0 ? std::exp2(29) / largest : 1;
  std::vector<IntegerPoint> out;
  out.reserve(points.size());
  for (const Point p : points) {
    out.emplace_back(static_cast<int>(std::lround(p.real() * scale)),
                     static_cast<int>(std::lround(p.imag() * scale)));
  }
  return out;
}

// The triangles, counter-clockwise. The points must be distinct; there may be fewer than three.
std::vector<Triangle> Delaunay(std::span<const Point> points) {
  const std::vector<IntegerPoint> grid = ToGrid(points);
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(grid.begin(), grid.end(), &diagram);

  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> around;
  for (const auto& vertex : diagram.vertices()) {
    // The sites round a Voronoi vertex lie on one circle: three of them, or more in a regular
    // lattice.
    around.clear();
    const auto* edge = vertex.incident_edge();
    do {
      around.push_back(static_cast<std::uint32_t>(edge->cell()->source_index()));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    for (std::size_t k = 2; k < around.size(); ++k) {
      Triangle triangle{around[0], around[k - 1], around[k]};
      const Point a = points[triangle[0]];
      if (Cross(points[triangle[1]] - a, points[triangle[2]] - a) < 0) {
        std::swap(triangle[1], triangle[2]);
      }
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

// Lattice points nearer to the outline than this share of an edge would make thin triangles.
constexpr double kClearance = 0.7;
// Triangles between neighbours on a nearly straight outline have their centroid on it.
constexpr double kSliver = 0.05;
constexpr int kSmoothings = 12;

// A hexagonal lattice over the inside of the outline's box, symmetric about x = 0.
void AddLattice(const Field& field, double edge, std::vector<Point>& points) {
  double left = 0, right = 0, bottom = points[0].imag(), top = bottom;
  for (const Point p : points) {
    left = std::min(left, p.real());
    right = std::max(right, p.real());
    bottom = std::min(bottom, p.imag());
    top = std::max(top, p.imag());
  }
  const double row_height = edge * std::sqrt(3.0) / 2;
  const auto rows = static_cast<int>((top - bottom) / row_height) + 1;
  const auto columns = static_cast<int>(std::max(-left, right) / edge) + 1;
  for (int row = 0; row < rows; ++row) {
    const double y = bottom + (row + 0.5) * row_height;
    const double shift = row % 2 == 0 ? 0 : 0.5;
    for (int column = -columns; column <= columns; ++column) {
      const Point p((column + shift) * edge, y);
      if (field(p) < -kClearance * edge) points.push_back(p);
    }
  }
}

std::vector<Triangle> InnerTriangles(const Field& field, double edge,
                                     const std::vector<Point>& points) {
  std::vector<Triangle> triangles = Delaunay(points);
  std::erase_if(triangles, [&](const Triangle& t) {
    return field((points[t[0]] + points[t[1]] + points[t[2]]) / 3.0) > -kSliver * edge;
  });
  return triangles;
}

// Moves every inner point to the mean of its neighbours, which evens out the rim of the lattice.
void Smooth(const std::vector<Triangle>& triangles, std::size_t outline_count,
            std::vector<Point>& points) {
  std::vector<Point> sum(points.size());
  std::vector<double> count(points.size());
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum[t[k]] += points[t[(k + 1) % 3]] + points[t[(k + 2) % 3]];
      count[t[k]] += 2;
    }
  }
  for (std::size_t v = outline_count; v < points.size(); ++v) {
    if (count[v] > 0) points[v] = sum[v] / count[v];
  }
}

}  // namespace

PlanarMesh MeshField(const Field& field, Point start, double edge) {
  std::vector<Point> points = SampleOutline(field, start, edge);
  const std::size_t outline_count = points.size();
  AddLattice(field, edge, points);
  for (int i = 0; i < kSmoothings; ++i) {
    Smooth(InnerTriangles(field, edge, points), outline_count, points);
  }
  for (Point& p : points) p = Rounded(p);

  std::vector<Triangle> triangles = InnerTriangles(field, edge, points);
  return {std::move(points), std::move(triangles)};
}

}  // namespace arap::cli
