// Flattening: a surface cut into charts, every chart laid in the plane, as rigidly as possible
// [II09 §7].
//
// Either in one go, or prepared once and flattened again and again: with other pins, anchors and
// weights, but the same cuts.
#pragma once

#include <cstddef>
#include <memory>

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

// Crossings of a chart's boundary are counted up to this.
inline constexpr std::size_t kMaxReportedCrossings = 1000;

// Stateless, thread-safe. `limits` bound the input. Faults: those of CutToCharts and
// CheckEnergyOptions, kInvalidOption (pins and grain lines by their field), kNotInjective,
// kNumerical, and whatever `cancel` answers between the phases and in the long loops. Unreferenced
// vertices get the uv (0, 0) and a warning.
Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const MeshLimits& limits = {}, const CancelToken& cancel = {},
                           PinSolver solver = PinSolver::kAuto);

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

// Faults: those of CutToCharts.
Result<std::shared_ptr<const PreparedSurface>> Prepare(SurfaceMesh mesh, const CutOptions& cut,
                                                       const MeshLimits& limits = {},
                                                       const CancelToken& cancel = {});

// As above, with `options.cut` already done.
Result<Flattening> Flatten(const PreparedSurface& surface, const FlattenOptions& options,
                           const CancelToken& cancel = {}, PinSolver solver = PinSolver::kAuto);

}  // namespace arap
