// Pieces: what a surface falls into when sides of it are taken apart: which corners still share a
// vertex, which triangles still hang together, and what bounds them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "core/mesh/gluing.h"
#include "core/mesh/topology.h"

namespace arap {

// Vertices where parts of the surface touch in nothing else, ascending: the triangles around such a
// vertex are not one fan or one ring. Cuts are ignored and edges of three and more triangles count
// as joining them all. `gluing` is what GlueAll makes of the sides; what is cut in it plays no part.
// O(#F), and O(#F α) where there are such edges.
std::vector<std::uint32_t> TouchingVertices(std::size_t vertex_count,
                                            std::span<const Triangle> triangles,
                                            std::span<const Side> sides, const Gluing& gluing);

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

// Triangles that hang together through joined sides, and what they are topologically.
struct Piece {
  std::vector<std::uint32_t> triangles;        // ascending
  std::vector<std::uint32_t> vertices;         // in the order in which the triangles name them
  std::vector<std::uint32_t> boundary_starts;  // one open side of each boundary loop, ascending
  std::int64_t euler = 0;
  std::int64_t genus = 0;  // handles

  bool closed() const { return boundary_starts.empty(); }
  bool planar() const { return !closed() && genus == 0; }
  bool disk() const { return planar() && boundary_starts.size() == 1; }
  // "closed, of genus 2", "of genus 1 with 3 boundaries".
  std::string Describe() const;
};

// Connected through joined sides, by their lowest triangle. `triangles` must agree and have one
// vertex per fan (Split). O(#F).
std::vector<Piece> FindPieces(std::size_t vertex_count, std::span<const Triangle> triangles,
                              const Gluing& gluing);

// One boundary of a mesh.
struct BoundaryLoop {
  std::uint32_t component = 0;          // of its vertices
  double length = 0;                    // unit of the mesh
  std::vector<std::uint32_t> vertices;  // as its triangles run, from the lowest vertex
};

// By component; the longest loop of a component comes first (of several as long up to rounding that
// with the lowest vertex), the others follow by their lowest vertex. Of a flat, upright chart the
// outline runs counter-clockwise and holes clockwise. The triangles must agree and no two parts may
// touch in a vertex only, as CutToCharts leaves them. `sides` is what SortedSides makes of the triangles,
// `component` (#V, or empty where there is one) as in Topology. O(#F).
std::vector<BoundaryLoop> BoundaryLoops(const SurfaceMesh& mesh, std::span<const Side> sides,
                                        std::span<const std::uint32_t> component = {});

}  // namespace arap
