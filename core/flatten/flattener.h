// Flattening: a surface cut into charts, every chart laid in the plane, as rigidly as possible
// [II09 §7].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/result.h"
#include "core/cut/cut_surface.h"
#include "core/energy/options.h"
#include "core/flatten/distortion.h"
#include "core/mesh/mesh.h"
#include "core/mesh/validation.h"

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

// A vertex held at `uv`, in the units of the input; where a cut doubles it, the first copy on each
// chart. A pin that is alone on its chart is met whatever its weight.
struct UvPin {
  std::uint32_t vertex = 0;
  Complex uv;         // at most kMaxPinDistance diagonals of the largest chart from 0
  double weight = 0;  // 0: exactly; else on the squared distance, kMinPinWeight…kMaxPinWeight
};

// How several pins on a chart are solved for. Both ways give the same layout.
enum class PinSolver {
  kAuto,       // by the number of pins; factored in too where the other way is not exact
  kNullSpace,  // on factors that serve any pins, a back-substitution per pin; or kNumerical
  kDirect,     // pins factored in
};

// Above this many pins on a chart kAuto factors them in: each costs two back-substitutions, and a
// number per vertex and iteration.
inline constexpr std::size_t kDirectPins = 32;

// The direction from one vertex to another of the same chart, radians from the u axis.
struct GrainLine {
  std::uint32_t from = 0, to = 0;
  double angle = 0;
};

inline constexpr int kMaxFlattenRefine = 1000;
inline constexpr double kMaxPinWeight = 1e9;
inline constexpr double kMinPinWeight = 1e-9;
inline constexpr double kMaxPinDistance = 1e6;
inline constexpr std::size_t kMaxReportedCrossings = 1000;

struct FlattenOptions {
  FlattenMethod method = FlattenMethod::kArap;
  EnergyOptions energy{Basis::kFace, Weights::kCotangent, {}};  // rigidity per input triangle
  FlattenAnchors anchors = FlattenAnchors::kCentreEdge;
  // At most so many local/global iterations with FACE cells and cotangent weights, which descend
  // the energy that is reported; they end when one lowers it by less than `refine_stop` of it.
  int refine = 0;
  double refine_stop = 0;
  bool injective = false;  // no flipped triangle, or kNotInjective
  CutOptions cut;
  std::vector<UvPin> pins;
  PinSolver pin_solver = PinSolver::kAuto;
  std::vector<GrainLine> grain_lines;
};

// One connected piece of the layout. Indices are into Flattening::uv.
struct FlatChart {
  std::vector<std::vector<std::uint32_t>> loops;  // ordered boundaries, the longest first
  std::vector<std::uint32_t> anchors;             // two, or none with several pins or kSpectral
  std::size_t triangles = 0;
  Distortion distortion;
  std::size_t crossings = 0;  // pairs of boundary segments that cross, counted up to a cap
  int refinements = 0;        // iterations taken
};

// Where the time went: processor time of the calling thread, milliseconds.
struct FlattenTimes {
  double topology = 0;  // checks, cuts and charts; 0 for a surface that was prepared before
  double order = 0;     // fill-reducing orders
  double factor = 0;    // factorisations; a factor that was kept costs nothing here nor above
  double solve = 0;     // all the rest

  double total() const { return topology + order + factor + solve; }
};

struct Flattening {
  std::vector<Complex> uv;                              // #U; true to size
  std::vector<std::uint32_t> source;                    // #U, input vertices; the first #V in order
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
};

// Stateless, thread-safe. Faults: those of CutToCharts and CheckEnergyOptions, kInvalidOption (pins
// and grain lines by their field), kNotInjective, kNumerical, and whatever `cancel` answers between
// the phases and in the long loops. Unreferenced vertices get the uv (0, 0) and a warning.
Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const CancelToken& cancel = {});

}  // namespace arap
