// Corners: which triangle corners share a vertex once sides have been taken apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"
#include "core/mesh/gluing.h"

namespace arap {

// Vertices where parts of the surface touch in nothing else, ascending: the triangles around such a
// vertex are not one fan or one ring. Cuts are ignored and edges of three and more triangles count
// as joining them all. O(#F α).
std::vector<std::uint32_t> TouchingVertices(std::size_t vertex_count,
                                            std::span<const Triangle> triangles,
                                            std::span<const Side> sides);

// Triangles with one vertex per fan of joined triangles.
struct SplitVertices {
  std::vector<Triangle> triangles;    // #F, on the new vertices
  std::vector<std::uint32_t> source;  // per new vertex the old one; old vertices first, in order
};

// The first fan of a vertex, by triangle, keeps its number; copies are numbered as triangles come
// to them. The triangles must agree across joined sides. O(#F α).
SplitVertices Split(std::size_t vertex_count, std::span<const Triangle> triangles,
                    const Gluing& gluing);

// Joins the two sides of an edge that still share both vertices: a cut of one edge inside a
// surface, or two of many triangles on one edge that go round its ends together. With `split` made
// of `gluing`. Returns a side of each that was cut. O(#F).
std::vector<std::uint32_t> JoinUnparted(const SplitVertices& split, std::span<const Side> sides,
                                        Gluing& gluing);

}  // namespace arap
