#include "core/cut/seams.h"

#include <algorithm>

#include <fmt/format.h>

namespace arap {

Result<Seams> FindSeams(std::span<const std::array<std::uint32_t, 2>> entries,
                        std::span<const Side> sides) {
  Seams seams;
  std::vector<bool> taken(entries.empty() ? 0 : sides.size(), false);  // the first side of an edge
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto [low, high] = std::minmax(entries[i][0], entries[i][1]);
    const Side wanted{low, high, 0};
    const auto begin = std::lower_bound(
        sides.begin(), sides.end(), wanted,
        [](const Side& a, const Side& b) { return a.v0 != b.v0 ? a.v0 < b.v0 : a.v1 < b.v1; });
    if (begin == sides.end() || !begin->SameEdge(wanted)) {
      return Fail(Fault(FaultKind::kUnknownEdge,
                        fmt::format("seam {} runs from vertex {} to vertex {}, which is no edge of "
                                    "the mesh",
                                    i, entries[i][0], entries[i][1]))
                      .Field(fmt::format("seams[{}]", i))
                      .Elements({entries[i][0], entries[i][1]}));
    }
    const auto first = static_cast<std::size_t>(begin - sides.begin());
    if (taken[first]) continue;
    taken[first] = true;
    auto end = begin;
    while (end != sides.end() && end->SameEdge(wanted)) ++end;
    if (end - begin == 1) {
      seams.on_boundary.push_back(static_cast<std::uint32_t>(i));
    } else {
      seams.edges.emplace_back(begin, end);
    }
  }
  return seams;
}

}  // namespace arap
