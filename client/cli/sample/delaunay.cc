#include "client/cli/sample/delaunay.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <boost/polygon/voronoi.hpp>

namespace arap::cli {
namespace {

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

}  // namespace

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

}  // namespace arap::cli
