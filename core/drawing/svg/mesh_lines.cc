#include "core/drawing/svg/mesh_lines.h"

#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace arap::cli {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Neighbours = std::map<std::uint32_t, std::set<std::uint32_t>>;

std::set<Edge> DirectedEdges(std::span<const std::uint32_t> triangles) {
  std::set<Edge> edges;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.emplace(triangles[t + k], triangles[t + (k + 1) % 3]);
    }
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

Lines BoundaryLines(std::span<const std::uint32_t> triangles) {
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

Lines InnerLines(std::span<const std::uint32_t> triangles) {
  const std::set<Edge> edges = DirectedEdges(triangles);
  Neighbours inner;
  for (const auto& [a, b] : edges) {
    if (edges.contains({b, a})) inner[a].insert(b);
  }
  return WalkAll(/*both_ways=*/true, std::move(inner));
}

std::string PathData(const Lines& lines, bool closed, std::span<const double> positions,
                     const View& view) {
  std::string out;
  for (const auto& line : lines) {
    long x = 0, y = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const double px = positions[2 * line[i]];
      const double py = positions[2 * line[i] + 1];
      // Differences of rounded places: nothing adds up along the line.
      const long next_x = view.X(px);
      const long next_y = view.Y(py);
      const long dx = next_x - x;
      const long dy = next_y - y;
      const char* const lead = i == 0 ? "M" : i == 1 ? "l" : dx < 0 ? "" : " ";
      fmt::format_to(std::back_inserter(out), "{}{}{}{}", lead, dx, dy < 0 ? "" : " ", dy);
      x = next_x;
      y = next_y;
    }
    if (closed) out += 'z';
  }
  return out;
}

}  // namespace arap::cli
