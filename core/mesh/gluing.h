// Gluing: which triangle sides are joined. Cutting a surface is taking sides apart.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

// Sides are numbered as in topology.h.
struct Gluing {
  std::vector<std::uint32_t> mate;  // 3·#F: the other side of the edge; kNone unless it has two
  std::vector<bool> cut;            // 3·#F: taken apart from its mate; the same on both sides

  bool open(std::uint32_t side) const { return mate[side] == kNone || cut[side]; }
  // From an open side to the open side that starts where it ends, through the triangles between.
  // The triangles must agree.
  std::uint32_t NextOpen(std::uint32_t side) const {
    for (side = NextSide(side); !open(side);) side = NextSide(mate[side]);
    return side;
  }
  void Cut(std::uint32_t side) { cut[side] = cut[mate[side]] = true; }
  void Join(std::uint32_t side) { cut[side] = cut[mate[side]] = false; }
};

// All edges with two triangles joined, nothing cut. O(#F).
Gluing GlueAll(std::span<const Side> sides);

// Which triangles have to be turned round (corners 1 and 2 swapped) so that joined neighbours run
// alike. The lowest triangle of a surface stays as it is. Across cuts triangles are made to agree
// where nothing else decides. kNotOrientable with two triangles that cannot agree. O(#F).
Result<std::vector<bool>> TrianglesToTurn(std::span<const Triangle> triangles,
                                          const Gluing& gluing);

// Takes apart what keeps triangles from being oriented alike: where the surface comes round to itself the
// other way, half-way round from the lowest triangle. Every surface stays connected. Returns one side of
// each edge that was cut; none when TrianglesToTurn has no fault. O(#F).
std::vector<std::uint32_t> CutOneSided(std::span<const Triangle> triangles, Gluing& gluing);

// Turns them and renumbers the sides of `gluing` to match. O(#F).
void TurnTriangles(const std::vector<bool>& turned, std::vector<Triangle>& triangles,
                   Gluing& gluing);

}  // namespace arap
