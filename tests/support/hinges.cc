#include "tests/support/hinges.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "core/mesh/space.h"

namespace arap::testing {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
// Opposite vertex of the triangle that runs along a directed edge.
using Opposites = std::map<Edge, std::uint32_t>;

Opposites FindOpposites(const std::vector<Triangle>& triangles) {
  Opposites opposite;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) opposite[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
  }
  return opposite;
}

std::optional<std::uint32_t> Find(const Opposites& opposite, std::uint32_t i, std::uint32_t j) {
  const auto found = opposite.find({i, j});
  if (found == opposite.end()) return std::nullopt;
  return found->second;
}

// Edges as they are visited, each with the vertex on its left and the one on its right.
struct DirectedEdge {
  std::uint32_t i, j;
  std::optional<std::uint32_t> left, right;
};

std::vector<DirectedEdge> DirectedEdges(const std::vector<Triangle>& triangles, bool both) {
  const Opposites opposite = FindOpposites(triangles);
  std::vector<DirectedEdge> edges;
  const auto add = [&](std::uint32_t i, std::uint32_t j) {
    edges.push_back({i, j, Find(opposite, i, j), Find(opposite, j, i)});
  };
  std::map<Edge, bool> seen;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      if (!seen.emplace(Edge{low, high}, true).second) continue;
      add(low, high);
      if (both) add(high, low);
    }
  }
  return edges;
}

// Cotangent of the angle at `apex` in the triangle apex, i, j, by its definition.
double Cotangent(const Eigen::Vector3d& apex, const Eigen::Vector3d& i, const Eigen::Vector3d& j) {
  const Eigen::Vector3d a = i - apex;
  const Eigen::Vector3d b = j - apex;
  return a.dot(b) / a.cross(b).norm();
}

double EdgeWeight(const DirectedEdge& edge, const std::vector<Point3>& vertices, Weights weights,
                  bool both) {
  double weight = 1;
  if (weights == Weights::kCotangent) {
    weight = 0;
    for (const auto& apex : {edge.left, edge.right}) {
      if (apex)
        weight +=
            0.5 * Cotangent(Vec(vertices[*apex]), Vec(vertices[edge.i]), Vec(vertices[edge.j]));
    }
    weight = std::max(weight, kMinCotangent);
  }
  return both ? weight / 2 : weight;
}

std::vector<Point3> Raised(const std::vector<Complex>& vertices) {
  std::vector<Point3> raised;
  raised.reserve(vertices.size());
  for (const Complex& v : vertices) raised.push_back({v.real(), v.imag(), 0});
  return raised;
}

// (|c−a| cos ∠cab, ±|c−a| sin ∠cab).
Eigen::Vector2d LaidBeside(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c, bool above) {
  const Eigen::Vector3d along = (b - a).normalized();
  const double x = (c - a).dot(along);
  const double y = (c - a - x * along).norm();
  return {x, above ? y : -y};
}

}  // namespace

std::vector<Hinge> PlanarHinges(const PlanarMesh& mesh, bool both_directions, Weights weights) {
  const std::vector<Point3> vertices = Raised(mesh.vertices);
  std::vector<Hinge> hinges;
  for (const DirectedEdge& edge : DirectedEdges(mesh.triangles, both_directions)) {
    Hinge hinge;
    hinge.vertices = {edge.i, edge.j};
    if (edge.left) hinge.vertices.push_back(*edge.left);
    if (edge.right) hinge.vertices.push_back(*edge.right);
    for (const std::uint32_t v : hinge.vertices)
      hinge.rest.emplace_back(vertices[v][0], vertices[v][1]);
    hinge.weight = EdgeWeight(edge, vertices, weights, both_directions);
    hinges.push_back(std::move(hinge));
  }
  return hinges;
}

std::vector<Hinge> UnfoldedHinges(const SurfaceMesh& mesh, bool both_directions, Weights weights,
                                  Slip slip) {
  std::vector<Hinge> hinges;
  for (const DirectedEdge& edge : DirectedEdges(mesh.triangles, both_directions)) {
    const auto a = Vec(mesh.vertices[edge.i]);
    const auto b = Vec(mesh.vertices[edge.j]);
    Hinge hinge;
    hinge.vertices = {edge.i, edge.j};
    hinge.rest = {Eigen::Vector2d(0, 0), Eigen::Vector2d((b - a).norm(), 0)};
    if (edge.left) {
      hinge.vertices.push_back(*edge.left);
      hinge.rest.push_back(LaidBeside(a, b, Vec(mesh.vertices[*edge.left]), true));
    }
    if (edge.right) {
      const bool above = edge.left ? slip == Slip::kSameSide : slip == Slip::kBoundaryAbove;
      hinge.vertices.push_back(*edge.right);
      hinge.rest.push_back(LaidBeside(a, b, Vec(mesh.vertices[*edge.right]), above));
    }
    hinge.weight = EdgeWeight(edge, mesh.vertices, weights, both_directions);
    hinges.push_back(std::move(hinge));
  }
  return hinges;
}

}  // namespace arap::testing
