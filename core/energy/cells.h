// Cells: the pieces of a mesh that have one best similarity each [algorithm §1, II09 §4.2, §7].
//
// Every cell has fit edges, which decide its similarity t, and energy edges, which are compared
// with it. Rest vectors are in the cell's own frame, so that cells of a planar mesh and hinges of a
// surface laid flat one by one are the same thing. A table keeps one kind of cell in columns of
// numbers: what the local step reads, it reads once and in order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

// Cells [begin, end) of one table that lie on one component of the mesh.
struct CellRun {
  std::size_t begin = 0, end = 0;
  std::uint32_t component = 0;
};

// EDGE cells. A row is an edge i—j with its opposite vertices and stands for the cell i→j and,
// when `both`, also for j→i; each fits the edge and the edges from its first vertex to the opposite
// ones, all with weight 1, and compares the edge alone.
struct HingeTable {
  bool both = true;
  // #H. Of each vertex, where its point begins in a shape of x, y, x, y, …: twice its number. right is j at a boundary.
  std::vector<std::int32_t> i, j, left, right;
  // From i in the hinge's frame: to j, to left, to right (0 at a boundary).
  std::vector<double> along_x, along_y, left_x, left_y, right_x, right_y;
  std::vector<double> weight;  // of each cell
  std::vector<CellRun> runs;

  std::size_t size() const { return i.size(); }
  void Add(std::uint32_t from, std::uint32_t to, std::uint32_t left_vertex,
           std::uint32_t right_vertex, Complex to_j, Complex to_left, Complex to_right, double w);
};

// FACE cells: a triangle fits and compares its three edges. Weight k belongs to the edge opposite
// corner k.
struct FaceTable {
  std::vector<std::int32_t> v0, v1, v2;        // #T
  std::vector<double> e1_x, e1_y, e2_x, e2_y;  // from corner 0 to corners 1 and 2
  std::vector<double> weight0, weight1, weight2;
  std::vector<CellRun> runs;

  std::size_t size() const { return v0.size(); }
  void Resize(std::size_t triangles);
  void Set(std::size_t t, const Triangle& triangle, Complex to_1, Complex to_2,
           const double (&w)[3]);
};

// An edge of a star, from its middle.
struct Spoke {
  std::uint32_t a = 0, b = 0;
  Complex rest;  // p_b − p_a
  double weight = 0;
};

// VERTEX cells, and those that weld pieces meeting in a single vertex: a star fits and compares its
// spokes. Compressed rows: star s has spokes [begin[s], begin[s+1]).
struct StarTable {
  std::vector<std::uint32_t> begin{0};
  std::vector<Spoke> spokes;
  std::vector<double> size_of;  // Σ w |rest|²
  std::vector<CellRun> runs;

  std::size_t size() const { return size_of.size(); }
  void Add(std::span<const Spoke> star);
};

struct Cells {
  HingeTable hinges;
  FaceTable faces;
  StarTable stars;

  std::size_t bytes() const;
};

// A triangle laid flat: its corners in its own frame, counter-clockwise.
using TriangleFrame = std::function<std::array<Complex, 3>(std::uint32_t triangle)>;

struct CellSystem {
  Cells cells;
  std::size_t clamped = 0;  // edges whose cotangent was raised to kMinCotangent
};

// The warning "clamped_weights" of so many edges.
Warning ClampedWarning(std::size_t edges);

// Rigidity must be empty or one number in (0, kMaxRigidity] per triangle: kArrayLength,
// kInvalidOption.
Status CheckEnergyOptions(const EnergyOptions& options, std::size_t triangles);

// Builds the cells. FACE cells of a surface read nothing of a topology of one component, which may be
// empty then. `frame` gives each triangle's shape; for EDGE cells the two triangles of a
// hinge are unfolded about their edge, one on each side, as their orientation says. VERTEX cells
// need one common frame (planar meshes) and vertices without thousands of edges: kInvalidOption.
//
// Triangles in `left_out` (#F or empty) count next to nothing: their cotangents are replaced by
// kMinCotangent, so that a vertex that has no other triangle still has a place.
//
// Pieces that meet only in a joint vertex are welded there by one extra cell, the spokes of the
// joint: without it nothing would fix how they turn against each other. Where many meet, every two
// neighbouring pieces are welded, each with a few of its spokes.
Result<CellSystem> BuildCells(const std::vector<Triangle>& triangles, const Topology& topology,
                              const EnergyOptions& options, const TriangleFrame& frame, bool planar,
                              const std::vector<bool>& left_out = {});

}  // namespace arap
