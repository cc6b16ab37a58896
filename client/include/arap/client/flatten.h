// Flattening of surfaces: what to ask for and what comes back.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arap/client/energy.h"
#include "arap/client/mesh.h"

namespace arap::client {

enum class FlattenMethod {
  kDefault,    // both steps with the basis of the energy; FACE when that names none
  kArapEdge,   // the paper: both steps with EDGE cells
  kArapFace,   // both steps with FACE cells
  kLscm,       // least squares conformal: the first step alone with FACE cells and cotangents
  kFirstStep,  // the first step alone with the basis of the energy, EDGE by default
  kAbf,        // angle-based flattening, for comparison
};

enum class FlattenAnchors {
  kDefault,      // kCenterEdge; kSpectral for kLscm and kAbf
  kCenterEdge,   // the edge nearest to the area centroid, at its true length
  kFarBoundary,  // two boundary vertices far from each other, at their distance in space
  kSpectral,     // none: the least energy for a given spread of the boundary, scaled to the area
};

// A vertex held at a place of the plane, in the units of the input.
struct UvPin {
  std::uint32_t vertex = 0;
  double u = 0, v = 0;
  double weight = 0;  // 0: exactly; more: on the squared distance, up to 1e9
};

// The direction from one vertex to another on the same chart; at most one per chart.
struct GrainLine {
  std::uint32_t from_vertex = 0, to_vertex = 0;
  double angle_degrees = 0;  // counter-clockwise from the u axis
};

struct FlattenOptions {
  FlattenMethod method = FlattenMethod::kDefault;
  EnergyOptions energy;  // Basis::kVertex is not for surfaces
  FlattenAnchors anchors = FlattenAnchors::kDefault;
  std::optional<std::uint32_t> refine;  // local/global iterations after the steps, up to max_refine
  std::optional<double> refine_stop;    // relative fall of the energy that ends them
  bool injective = false;               // no flipped triangle, or kFailedPrecondition
  bool auto_cut = false;                // closed pieces, handles and several boundaries to disks
  bool split_non_manifold = false;      // instead of refusing it
  bool tolerate_degenerate = false;     // leave triangles without area out
  std::vector<std::uint32_t> seam_edges;  // vertex pairs a b a b… to cut along first
  std::vector<UvPin> pins;
  std::vector<GrainLine> grain_lines;
  std::string surface_key;  // the server keeps the prepared surface under this name for a while
  bool first_step = false;  // also answer the result of the first step
  bool singular_values = false;  // also answer s1 and s2 of every triangle
  bool float64 = false;          // uv in double precision on the wire, else single
};

// How far a mapping is from an isometry; s1 >= s2 are the singular values of a triangle's Jacobian.
// Means are weighted with the areas in space.
struct Distortion {
  double arap_energy = 0;          // of (s1 − 1)² + (s2 − 1)², relative to the area
  double symmetric_dirichlet = 0;  // of s1² + s2² + s1⁻² + s2⁻²; 4 for an isometry
  double area_ratio = 0;           // flat area / area in space
  double mean_stretch_percent = 0, max_stretch_percent = 0;          // of max(0, s1 − 1)
  double mean_compression_percent = 0, max_compression_percent = 0;  // of max(0, 1 − s2)
  double mean_angle_degrees = 0, max_angle_degrees = 0;  // largest change of a corner angle
  std::uint64_t flipped = 0;                             // triangles whose orientation is reversed
  double scale = 1;                                      // applied to the answer
  std::uint32_t worst_triangle = 0;                      // with the largest max(s1, 1/s2)
};

// A connected piece of the layout. Indices are flat positions.
struct FlatChart {
  std::vector<std::vector<std::uint32_t>> loops;  // ordered boundaries, the longest first
  std::vector<std::uint32_t>
      anchors;  // two that fixed the first step; empty with pins or kSpectral
  std::uint64_t triangle_count = 0;
  Distortion distortion;
  std::uint64_t boundary_crossings = 0;  // pairs of its boundary segments that cross
  std::uint32_t refinements = 0;         // local/global iterations taken
};

// A flat surface, true to size: uv in the units of the input.
struct FlatSurface {
  std::vector<double> uv;                // u v u v…, length 2·#U; #U > #V where seams were cut
  std::vector<std::uint32_t> uv_vertex;  // the input vertex of each flat position, length #U
  std::vector<std::uint32_t> corner_uv;  // the flat position of each triangle corner, length 3·#F
  std::vector<double> first_step_uv;     // length 2·#U, when asked
  std::vector<double> singular_values;   // s1 s2 s1 s2…, length 2·#F, when asked
  Distortion distortion;
  std::vector<Warning> warnings;
  std::vector<std::uint32_t> anchor_vertices;  // input vertices that anchored the first chart
  std::vector<FlatChart> charts;
  std::vector<std::uint32_t> triangle_chart;  // length #F
  std::vector<std::uint32_t> cut_edges;  // input vertex pairs a b a b…: seams, automatic cuts
  std::uint32_t auto_cut_count = 0;      // how many of them, at the end, are automatic
  std::vector<std::uint32_t> left_out_triangles;
  bool boundary_overlaps = false;  // boundaries cross within a chart or between charts
  bool surface_cached = false;     // the server had the surface under surface_key
  double queue_micros = 0;
  double solve_micros = 0;
};

}  // namespace arap::client
