// Flattening: what to ask for, what comes back, and how far that is from an isometry [II09 §7].
//
// #V and #F are the vertices and triangles of the surface that was given, #U the vertices of the
// flat one, which has copies along every cut. Lengths, places and uv are in the unit of the input.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "arap/model/repair.h"

namespace arap {

enum class FlattenMethod {
  kArap,       // both steps with the basis of the energy [II09 §7]
  kFirstStep,  // the first step alone; with FACE cells and cotangent weights this is LSCM
  kAbf,        // angle-based flattening, laid out by least squares
};

enum class FlattenAnchors {
  kCentreEdge,   // the edge nearest to the area centroid, at its true length [II09 §7]
  kFarBoundary,  // two boundary vertices far from each other, at their distance in space
  kSpectral,     // none: least energy for a given spread of the boundary, scaled to the true area
};

// A vertex held at `uv`; where a cut doubles it, the first copy on each chart. A pin that is alone
// on its chart is met whatever its weight.
struct UvPin {
  std::uint32_t vertex = 0;  // of the input
  Complex uv;                // at most kMaxPinDistance diagonals of the largest chart from 0
  double weight = 0;  // 0: exactly; else on the squared distance, kMinPinWeight…kMaxPinWeight

  bool operator==(const UvPin&) const = default;
};

// The direction from one vertex to another of the same chart, radians from the u axis.
struct GrainLine {
  std::uint32_t from = 0, to = 0;  // of the input
  double angle = 0;

  bool operator==(const GrainLine&) const = default;
};

// Bounds of what can be asked for.
inline constexpr int kMaxFlattenRefine = 1000;
inline constexpr double kMaxPinWeight = 1e9;
inline constexpr double kMinPinWeight = 1e-9;
inline constexpr double kMaxPinDistance = 1e6;

// How a surface becomes charts that can be laid flat.
struct CutOptions {
  // Edges to cut, as pairs of vertices in either order. Repeated entries count once; an edge of the
  // boundary, and one that parts nothing because it is cut on its own inside the surface, is left
  // alone with a warning. An edge of three or more triangles is cut apart into all of them.
  std::vector<std::array<std::uint32_t, 2>> seams;
  // Cut whatever is then no disk: one-sided surfaces, closed ones, handles and all boundaries but one,
  // along short paths that keep to places of high curvature.
  bool auto_cut = false;
  // Edges of three or more triangles become boundary of all of them, and a vertex where parts touch
  // in nothing else is doubled, instead of being faults.
  bool split_non_manifold = false;
  // Triangles without area are let through. Not when a whole chart has none.
  bool tolerate_degenerate = false;
  // What is mended before anything else. Seams, pins and grain lines may name any vertex of those that
  // are welded, and an edge that is split when it is stitched.
  RepairOptions repair;

  bool operator==(const CutOptions&) const = default;
};

struct FlattenOptions {
  FlattenMethod method = FlattenMethod::kArap;
  // FACE or EDGE cells, rigidity per input triangle. kAbf takes FACE cells with cotangents only.
  EnergyOptions energy{Basis::kFace, Weights::kCotangent, {}};
  FlattenAnchors anchors = FlattenAnchors::kCentreEdge;
  // At most so many accelerated local/global iterations with FACE cells and cotangent weights, which
  // descend the energy that is reported, 0 to kMaxFlattenRefine; they end when two in a row lower it
  // by less than the part `refine_stop` of it each, 0 to 1. At 0 they end when nothing lowers it.
  int refine = 0;
  double refine_stop = 0;
  bool injective = false;  // no flipped triangle, or kNotInjective
  CutOptions cut;
  std::vector<UvPin> pins;
  std::vector<GrainLine> grain_lines;  // at most one per chart

  bool operator==(const FlattenOptions&) const = default;
};

// What the service computes unless a request says otherwise: FlattenOptions that are written out in
// full, to be changed where something else is wanted. The ARAP energy is refined until it has
// converged; the others are the first step alone, and where nothing mends what anchors do to size
// and flips, there are none.
inline constexpr int kServiceRefine = kMaxFlattenRefine;
inline constexpr double kServiceRefineStop = 3e-5;

// Both steps. Basis::kFace, or a kEdge… for the paper's.
inline FlattenOptions ArapOptions(Basis basis = Basis::kFace) {
  FlattenOptions options;
  options.energy.basis = basis;
  options.refine = kServiceRefine;
  options.refine_stop = kServiceRefineStop;
  return options;
}

// The first step of the paper.
inline FlattenOptions FirstStepOptions(Basis basis = Basis::kEdge) {
  FlattenOptions options;
  options.method = FlattenMethod::kFirstStep;
  options.energy.basis = basis;
  options.refine_stop = kServiceRefineStop;
  return options;
}

// Least squares conformal maps.
inline FlattenOptions LscmOptions() {
  FlattenOptions options = FirstStepOptions(Basis::kFace);
  options.anchors = FlattenAnchors::kSpectral;
  return options;
}

// Angle-based flattening.
inline FlattenOptions AbfOptions() {
  FlattenOptions options = LscmOptions();
  options.method = FlattenMethod::kAbf;
  return options;
}

// Measures of a mapping, area-weighted with rest areas. s1 >= s2 are the singular values of a
// triangle's Jacobian; both enter unsigned, except in the ARAP energy, where a flipped triangle has
// s2 < 0.
struct Distortion {
  double arap_energy = 0;           // Σ A((s1−1)² + (s2−1)²) / ΣA
  double symmetric_dirichlet = 4;   // Σ A(s1² + s2² + s1⁻² + s2⁻²) / ΣA, at most 1e30
  double area_ratio = 1;            // Σ A·s1·s2 / ΣA (unsigned)
  double mean_stretch_percent = 0;  // mean of max(0, s1 − 1)
  double max_stretch_percent = 0;
  double mean_compression_percent = 0;  // mean of max(0, 1 − s2)
  double max_compression_percent = 0;
  double mean_angle_degrees = 0;  // mean of the largest change of a corner angle
  double max_angle_degrees = 0;
  std::size_t flipped = 0;
  std::uint32_t worst_triangle = 0;  // with the largest max(s1, 1/s2)

  bool operator==(const Distortion&) const = default;
};

// Crossings of a chart's boundary are counted up to this.
inline constexpr std::size_t kMaxReportedCrossings = 1000;

// How the refinements of a chart ended.
enum class RefineEnd {
  kNotRefined,  // nothing was asked for
  kConverged,   // another one would bring next to nothing
  kLimit,       // so many were asked for at most
};

// One connected piece of the layout. Indices are flat positions, below #U.
struct FlatChart {
  std::vector<std::vector<std::uint32_t>> loops;  // ordered boundaries, the longest first
  std::vector<std::uint32_t> anchors;             // two, or none with several pins or kSpectral
  std::size_t triangles = 0;
  Distortion distortion;
  // Pairs of boundary segments that cross, at most kMaxReportedCrossings.
  std::size_t crossings = 0;
  int refinements = 0;  // iterations taken
  RefineEnd refine_end = RefineEnd::kNotRefined;

  bool operator==(const FlatChart&) const = default;
};

// Where the time went: processor time of the calling thread, milliseconds.
struct FlattenTimes {
  double topology = 0;  // checks, cuts and charts; 0 for a surface that was prepared before
  double order = 0;     // fill-reducing orders
  double factor = 0;    // factorisations; a factor that was kept costs nothing here nor above
  double solve = 0;     // all the rest

  double total() const { return topology + order + factor + solve; }
  bool operator==(const FlattenTimes&) const = default;
};

// A flat surface, true to size, every chart on its smallest rectangle. #U > #V where it was cut.
struct Flattening {
  std::vector<Complex> uv;            // #U
  std::vector<std::uint32_t> source;  // #U, input vertices; the first #V in order
  // #V where vertices were welded, else empty: the vertex that stands for each. Corners have positions
  // whose `source` stands for theirs, and a welded vertex lies where its lowest triangle has it.
  std::vector<std::uint32_t> welded;
  std::vector<std::array<std::uint32_t, 3>> corner_uv;  // #F, in the order of the input's corners
  std::vector<std::uint32_t> triangle_chart;            // #F
  std::vector<FlatChart> charts;                        // by lowest triangle
  std::vector<Complex> first_step;                      // #U, after the first step (Fig. 6a)
  // #F, s1 >= |s2|, s2 negative when flipped; 0 0 for a triangle left out.
  std::vector<std::array<double, 2>> singular_values;
  Distortion distortion;  // of all charts
  bool overlaps = false;  // boundaries cross within a chart or between charts
  std::vector<std::array<std::uint32_t, 2>> cuts;  // input vertex pairs: seams, automatic cuts
  std::size_t auto_cuts = 0;                       // how many of `cuts`, at the end, are automatic
  std::vector<std::uint32_t> degenerate;           // triangles left out
  std::vector<Warning> warnings;
  FlattenTimes times;

  bool operator==(const Flattening&) const = default;
};

}  // namespace arap
