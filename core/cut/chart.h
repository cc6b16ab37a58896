// Charts: the pieces that a cut surface falls into, and what each is topologically.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "core/mesh/gluing.h"

namespace arap {

struct Chart {
  std::vector<std::uint32_t> triangles;        // ascending
  std::vector<std::uint32_t> vertices;         // in the order in which the triangles name them
  std::vector<std::uint32_t> boundary_starts;  // one open side of each boundary loop, ascending
  std::int64_t euler = 0;
  std::int64_t genus = 0;  // handles

  bool closed() const { return boundary_starts.empty(); }
  bool planar() const { return !closed() && genus == 0; }
  bool disk() const { return planar() && boundary_starts.size() == 1; }
  // "closed, of genus 2", "with 3 boundaries and 1 handle".
  std::string Describe() const;
};

// Connected through joined sides, by their lowest triangle. `triangles` must agree and have one
// vertex per fan (Split). O(#F α).
std::vector<Chart> FindCharts(std::size_t vertex_count, std::span<const Triangle> triangles,
                              const Gluing& gluing);

}  // namespace arap
