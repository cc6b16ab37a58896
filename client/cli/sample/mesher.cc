#include "client/cli/sample/mesher.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "client/cli/sample/delaunay.h"
#include "client/cli/sample/outline.h"

namespace arap::cli {
namespace {

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
