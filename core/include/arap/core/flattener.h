// Flattening: a surface cut into charts, every chart laid in the plane, as rigidly as possible
// [II09 §7].
//
// Either in one go, or prepared once and flattened again and again: with other pins, anchors and
// weights, but the same cuts. Each step and kind of cells costs a factorisation, O(n^1.5) for a
// chart of n vertices; every refinement and every pin costs two back-substitutions.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/flatten.h"

namespace arap {

struct PreparedSurfaceParts;

// How several pins on a chart are solved for. Both ways give the same layout.
enum class PinSolver {
  kAuto,       // by the number of pins; factored in too where the other way is not exact
  kNullSpace,  // on factors that serve any pins, a back-substitution per pin; or kNumerical
  kDirect,     // pins factored in
};

// Above this many pins on a chart kAuto factors them in: each costs two back-substitutions, and a
// number per vertex and iteration.
inline constexpr std::size_t kDirectPins = 32;

// Told how much of the work is done, 0 to 1, with a word for what is being done: "cutting",
// "charts", "layout". From the thread of the work; may be empty.
using FlattenProgress = std::function<void(std::string_view phase, double fraction)>;

// What can be said of the options without the surface, of which only the number of triangles
// counts: Flatten says the same before anything else. Faults: kInvalidOption (field "refine",
// "refine_stop", "repair.tolerance", "energy.basis", "energy.weights", "energy.rigidity", "pins[i].u", "pins[i].v",
// "pins[i].weight", "grain_lines[i].angle"), kArrayLength ("energy.rigidity").
Status CheckFlattenOptions(const FlattenOptions& options, std::size_t triangles);

// Stateless, thread-safe. `limits` bound the input. Faults, in this order: those of
// CheckFlattenOptions; those of CutToCharts; for pins and grain lines that do not fit the surface
// kIndexOutOfRange and kInvalidOption (fields "pins[i]…" and "grain_lines[i]…"); kNotInjective;
// kNumerical; kOutOfMemory; and whatever `cancel` answers between the phases and in the long loops.
// Unreferenced vertices get the uv (0, 0) and a warning.
Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const MeshLimits& limits = {}, const CancelToken& cancel = {},
                           PinSolver solver = PinSolver::kAuto,
                           const FlattenProgress& progress = {});

// A surface validated, cut and split into charts. Immutable but for the factors that it keeps;
// thread-safe. What is kept: the charts, the elimination orders, and the factors of the last few
// kinds of flattening. The same method, edge weights and anchors ask for no factorisation, whatever
// is pinned where and how firmly; nor do layouts without pins after layouts with them. Other edge
// weights are other matrices: factored once, in the order that is there. More than kDirectPins pins
// on a chart are factored in, and factors with rigidity are not kept. The answer is the same to the
// last bit as without any of this.
class PreparedSurface {
 public:
  explicit PreparedSurface(std::unique_ptr<const PreparedSurfaceParts> parts);
  ~PreparedSurface();
  PreparedSurface(const PreparedSurface&) = delete;
  PreparedSurface& operator=(const PreparedSurface&) = delete;

  // Grows as factors are kept.
  std::size_t bytes() const;

  // For the rest of this room.
  const PreparedSurfaceParts& parts() const { return *parts_; }

 private:
  std::unique_ptr<const PreparedSurfaceParts> parts_;
};

// Faults: those of CutToCharts, kOutOfMemory.
Result<std::shared_ptr<const PreparedSurface>> Prepare(SurfaceMesh mesh, const CutOptions& cut,
                                                       const MeshLimits& limits = {},
                                                       const CancelToken& cancel = {});

// As Flatten of a mesh, with `options.cut` already done.
Result<Flattening> Flatten(const PreparedSurface& surface, const FlattenOptions& options,
                           const CancelToken& cancel = {}, PinSolver solver = PinSolver::kAuto,
                           const FlattenProgress& progress = {});

// What the cost of flattening a surface depends on.
struct SurfaceSize {
  std::size_t vertices = 0, triangles = 0;
  std::size_t charts = 1;   // before seams and automatic cuts
  std::size_t largest = 0;  // vertices of the largest chart
};

// For a mesh of any kind, before it is validated; indices that name no vertex count for nothing.
// Vertices where parts only touch hold a chart together unless `cut` splits them. O(#F α), with
// split_non_manifold O(#F log #F).
SurfaceSize SizeOf(const SurfaceMesh& mesh, const CutOptions& cut = {});

// What a flattening will take, before it is begun.
struct FlattenCost {
  double milliseconds = 0;  // of processor time
  std::size_t bytes = 0;    // at the peak, the surface and the answer included
};

// `keep`: the surface is prepared to be flattened again. Fitted to a grid of sizes
// (docs/operations.md): within a factor of 2 of the time and of 1.3 of the memory for surfaces
// numbered row by row. Two things are not known before: how often a descent refines, which is taken
// to be 20 times at most, or `refine` in full where refine_stop is below the service's; and whether
// an injective layout has to be searched for, which is taken to be so, without Newton steps.
FlattenCost EstimateFlatten(const SurfaceSize& size, const FlattenOptions& options,
                            bool keep = false);

}  // namespace arap
