// Seams: the edges that the caller wants cut.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "core/mesh/sides.h"

namespace arap {

struct Seams {
  std::vector<std::span<const Side>> edges;  // in the order given, each once, all its sides
  std::vector<std::uint32_t> on_boundary;    // entries that name an edge of one triangle
};

// kUnknownEdge for an entry that is no edge. The spans point into `sides` (SortedSides).
Result<Seams> FindSeams(std::span<const std::array<std::uint32_t, 2>> entries,
                        std::span<const Side> sides);

}  // namespace arap
