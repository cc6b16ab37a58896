#include "core/mesh/topology.h"

#include <algorithm>

#include "core/mesh/union_find.h"

namespace arap {
namespace {

// One side of a triangle, sortable so that the sides of one edge come together.
struct Side {
  std::uint32_t v0, v1;
  std::uint32_t triangle, corner;  // the side lies opposite this corner

  friend bool operator<(const Side& a, const Side& b) {
    if (a.v0 != b.v0) return a.v0 < b.v0;
    if (a.v1 != b.v1) return a.v1 < b.v1;
    return a.triangle < b.triangle;
  }
};

std::vector<Side> SortedSides(std::span<const Triangle> triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]);
      sides.push_back({low, high, t, k});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

void BuildEdges(std::span<const Triangle> triangles, Topology& topology) {
  topology.triangle_edges.resize(triangles.size());
  topology.edges.reserve(triangles.size() * 3 / 2 + 2);
  for (const Side& side : SortedSides(triangles)) {
    const bool same = !topology.edges.empty() && topology.edges.back().v0 == side.v0 &&
                      topology.edges.back().v1 == side.v1;
    if (!same) topology.edges.push_back({side.v0, side.v1, {}, {}});
    Edge& edge = topology.edges.back();
    const std::size_t slot = same ? 1 : 0;
    edge.triangle[slot] = side.triangle;
    edge.opposite[slot] = triangles[side.triangle][side.corner];
    if (!same) edge.triangle[1] = edge.opposite[1] = kNone;
    topology.triangle_edges[side.triangle][side.corner] =
        static_cast<std::uint32_t>(topology.edges.size() - 1);
  }
}

void NumberComponents(std::size_t vertex_count, std::span<const Triangle> triangles,
                      Topology& topology) {
  UnionFind sets(vertex_count);
  std::vector<bool> referenced(vertex_count, false);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) referenced[v] = true;
    sets.Join(t[0], t[1]);
    sets.Join(t[0], t[2]);
  }
  topology.vertex_component.assign(vertex_count, kNone);
  std::uint32_t next = 0;
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (!referenced[v]) {
      ++topology.unreferenced;
      continue;
    }
    const std::uint32_t root = sets.Find(v);
    topology.vertex_component[v] = root == v ? next++ : topology.vertex_component[root];
  }
  topology.components = next;
}

void NumberPieces(std::size_t vertex_count, std::span<const Triangle> triangles,
                  Topology& topology) {
  UnionFind sets(triangles.size());
  for (const Edge& edge : topology.edges) {
    if (!edge.boundary()) sets.Join(edge.triangle[0], edge.triangle[1]);
  }
  topology.triangle_piece.resize(triangles.size());
  std::uint32_t next = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t root = sets.Find(t);
    topology.triangle_piece[t] = root == t ? next++ : topology.triangle_piece[root];
  }
  topology.pieces = next;
  if (topology.pieces == topology.components) return;
  std::vector<std::uint32_t> piece_of(vertex_count, kNone);
  std::vector<bool> joint(vertex_count, false);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[t]) {
      if (piece_of[v] == kNone) piece_of[v] = topology.triangle_piece[t];
      if (piece_of[v] != topology.triangle_piece[t]) joint[v] = true;
    }
  }
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (joint[v]) topology.joints.push_back(v);
  }
}

// From boundary edge `edge`, round vertex `v` through the fan of triangles to the other boundary
// edge.
std::uint32_t NextBoundaryEdge(std::span<const Triangle> triangles, const Topology& topology,
                               std::uint32_t edge, std::uint32_t v) {
  std::uint32_t triangle = topology.edges[edge].triangle[0];
  while (true) {
    std::uint32_t next = kNone;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t candidate = topology.triangle_edges[triangle][k];
      if (candidate != edge && triangles[triangle][k] != v) next = candidate;
    }
    const Edge& e = topology.edges[next];
    if (e.boundary()) return next;
    triangle = e.triangle[0] == triangle ? e.triangle[1] : e.triangle[0];
    edge = next;
  }
}

// Boundary edges linked around their vertices form the loops. Needs no orientation.
void CountBoundaryLoops(std::span<const Triangle> triangles, Topology& topology) {
  UnionFind sets(topology.edges.size());
  for (std::uint32_t e = 0; e < topology.edges.size(); ++e) {
    if (!topology.edges[e].boundary()) continue;
    sets.Join(e, NextBoundaryEdge(triangles, topology, e, topology.edges[e].v0));
    sets.Join(e, NextBoundaryEdge(triangles, topology, e, topology.edges[e].v1));
  }
  for (std::uint32_t e = 0; e < topology.edges.size(); ++e) {
    if (topology.edges[e].boundary() && sets.Find(e) == e) ++topology.boundary_loops;
  }
}

}  // namespace

Topology BuildTopology(std::size_t vertex_count, std::span<const Triangle> triangles) {
  Topology topology;
  BuildEdges(triangles, topology);
  NumberComponents(vertex_count, triangles, topology);
  NumberPieces(vertex_count, triangles, topology);
  CountBoundaryLoops(triangles, topology);
  return topology;
}

}  // namespace arap
