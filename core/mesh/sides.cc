#include "core/mesh/sides.h"

#include <algorithm>

namespace arap {

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
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].v0 == sides[begin].v0) ++end;
    std::sort(sides.begin() + static_cast<std::ptrdiff_t>(begin),
              sides.begin() + static_cast<std::ptrdiff_t>(end), [](const Side& a, const Side& b) {
                return a.v1 != b.v1 ? a.v1 < b.v1 : a.index < b.index;
              });
  }
  return sides;
}

}  // namespace arap
