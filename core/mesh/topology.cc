#include "core/mesh/topology.h"

#include <algorithm>

namespace arap {
namespace {

void BuildEdges(std::span<const Triangle> triangles, std::span<const Side> sorted,
                Topology& topology) {
  std::size_t edges = 0;
  ForEachEdge(sorted, [&edges](std::span<const Side>) { ++edges; });
  topology.triangle_edges.resize(triangles.size());
  topology.edges.reserve(edges);
  ForEachEdge(sorted, [&](std::span<const Side> sides) {
    const auto index = static_cast<std::uint32_t>(topology.edges.size());
    Edge& edge = topology.edges.emplace_back();
    edge.v0 = sides[0].v0, edge.v1 = sides[0].v1;
    for (std::size_t slot = 0; slot < sides.size(); ++slot) {
      const std::uint32_t triangle = sides[slot].triangle(), corner = sides[slot].corner();
      edge.triangle[slot] = triangle;
      edge.opposite[slot] = triangles[triangle][corner];
      topology.triangle_edges[triangle][corner] = index;
    }
  });
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

// Sides that come by triangle stay so where they belong to one edge.
void SortByHigherVertex(std::span<Side> sides) {
  constexpr std::size_t kShort = 16;
  const auto before = [](const Side& a, const Side& b) { return a.v1 < b.v1; };
  if (sides.size() > kShort) {
    std::stable_sort(sides.begin(), sides.end(), before);
    return;
  }
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side side = sides[i];
    std::size_t to = i;
    for (; to > 0 && before(side, sides[to - 1]); --to) sides[to] = sides[to - 1];
    sides[to] = side;
  }
}

}  // namespace

std::vector<Side> SortedSides(std::size_t vertex_count, std::span<const Triangle> triangles) {
  const auto side_of = [&](std::uint32_t t, std::uint32_t k) {
    const auto [low, high] = std::minmax(triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]);
    return Side{low, high, 3 * t + k};
  };
  // Counted into one bucket per lower vertex, in the order of the triangles; a bucket is small.
  std::vector<std::uint32_t> start(vertex_count + 1, 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) ++start[side_of(t, k).v0 + 1];
  }
  for (std::size_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  std::vector<Side> sides(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Side side = side_of(t, k);
      sides[start[side.v0]++] = side;
    }
  }
  // Now start[v] is where the bucket of v ends.
  for (std::size_t v = 0, begin = 0; v < vertex_count; begin = start[v++]) {
    SortByHigherVertex(std::span(sides).subspan(begin, start[v] - begin));
  }
  return sides;
}

void TurnSides(const std::vector<bool>& turned, std::vector<Side>& sides) {
  for (Side& side : sides) {
    if (turned[side.triangle()] && side.corner() != 0) {
      side.index = 3 * side.triangle() + 3 - side.corner();
    }
  }
}

Topology BuildTopology(std::size_t vertex_count, std::span<const Triangle> triangles) {
  return BuildTopology(vertex_count, triangles, SortedSides(vertex_count, triangles));
}

Topology BuildTopology(std::size_t vertex_count, std::span<const Triangle> triangles,
                       std::span<const Side> sides) {
  Topology topology;
  BuildEdges(triangles, sides, topology);
  NumberComponents(vertex_count, triangles, topology);
  NumberPieces(vertex_count, triangles, topology);
  CountBoundaryLoops(triangles, topology);
  return topology;
}

}  // namespace arap
