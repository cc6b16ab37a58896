#include "core/drawing/mesh_lines.h"

#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace arap {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Neighbours = std::map<std::uint32_t, std::set<std::uint32_t>>;

std::set<Edge> DirectedEdges(std::span<const Triangle> triangles) {
  std::set<Edge> edges;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace(t[k], t[(k + 1) % 3]);
  }
  return edges;
}

// Walks from `start` along unused edges until there is none, and uses them up.
std::vector<std::uint32_t> Walk(std::uint32_t start, bool both_ways, Neighbours& unused) {
  std::vector<std::uint32_t> line{start};
  for (auto at = unused.find(start); at != unused.end() && !at->second.empty();
       at = unused.find(line.back())) {
    const std::uint32_t next = *at->second.begin();
    at->second.erase(next);
    if (both_ways) unused[next].erase(line.back());
    line.push_back(next);
  }
  return line;
}

Lines WalkAll(bool both_ways, Neighbours unused) {
  Lines lines;
  for (auto at = unused.begin(); at != unused.end(); ++at) {
    while (!at->second.empty()) lines.push_back(Walk(at->first, both_ways, unused));
  }
  return lines;
}

}  // namespace

Lines BoundaryLines(std::span<const Triangle> triangles) {
  const std::set<Edge> edges = DirectedEdges(triangles);
  Neighbours boundary;
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) boundary[a].insert(b);
  }
  Lines lines = WalkAll(/*both_ways=*/false, std::move(boundary));
  for (auto& line : lines) {
    if (line.size() > 1 && line.front() == line.back()) line.pop_back();
  }
  return lines;
}

Lines InnerLines(std::span<const Triangle> triangles) {
  const std::set<Edge> edges = DirectedEdges(triangles);
  Neighbours inner;
  for (const auto& [a, b] : edges) {
    if (edges.contains({b, a})) inner[a].insert(b);
  }
  return WalkAll(/*both_ways=*/true, std::move(inner));
}

}  // namespace arap
