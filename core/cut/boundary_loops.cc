#include "core/cut/boundary_loops.h"

#include <algorithm>
#include <utility>

#include "core/mesh/space.h"

namespace arap {
namespace {

// Lengths closer than this, relatively, are equal: rounding must not choose the outline.
constexpr double kTie = 1e-9;

// Where the boundary edge that starts at a vertex ends; kNone off the boundary.
std::vector<std::uint32_t> Successors(const SurfaceMesh& mesh, const Topology& topology) {
  std::vector<std::uint32_t> next(mesh.vertices.size(), kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& c = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (topology.edges[topology.triangle_edges[t][k]].boundary()) {
        next[c[(k + 1) % 3]] = c[(k + 2) % 3];
      }
    }
  }
  return next;
}

}  // namespace

std::vector<BoundaryLoop> BoundaryLoops(const SurfaceMesh& mesh, const Topology& topology) {
  std::vector<std::uint32_t> next = Successors(mesh, topology);
  std::vector<BoundaryLoop> loops;
  for (std::uint32_t start = 0; start < next.size(); ++start) {
    if (next[start] == kNone) continue;
    BoundaryLoop& loop = loops.emplace_back();
    loop.component = topology.vertex_component[start];
    for (std::uint32_t v = start; next[v] != kNone;) {
      loop.vertices.push_back(v);
      loop.length += (Vec(mesh.vertices[next[v]]) - Vec(mesh.vertices[v])).norm();
      v = std::exchange(next[v], kNone);
    }
  }
  std::stable_sort(loops.begin(), loops.end(), [](const BoundaryLoop& a, const BoundaryLoop& b) {
    return a.component < b.component;
  });
  for (auto begin = loops.begin(), end = begin; begin != loops.end(); begin = end) {
    auto longest = begin;
    for (; end != loops.end() && end->component == begin->component; ++end) {
      if (end->length > longest->length * (1 + kTie)) longest = end;
    }
    std::rotate(begin, longest, longest + 1);
  }
  return loops;
}

}  // namespace arap
