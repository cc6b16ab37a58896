// Frame: one set of targets on its way to a shape. For this folder only.
#pragma once

#include <span>
#include <vector>

#include "arap/base/crew.h"
#include "arap/base/result.h"
#include "arap/model/deform.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/target_rows.h"
#include "core/deform/vertex_runs.h"

namespace arap {

// One set of targets on its way to a shape, step by step [algorithm §2]. The rigid solve itself is
// left to the caller, so that several frames can share one pass over the factor.
//
// Coordinates are normalised and relative to the mean target. Allocates at construction only.
// Nothing is kept from one set of targets to the next.
class Frame {
 public:
  explicit Frame(const CompiledHandlesParts& set);

  // Who helps from now on, or nullptr.
  void Use(Crew* crew) { crew_ = crew; }

  // Checks the targets and takes step 1. Faults: those of TargetRows::Place and of a
  // back-substitution.
  Status Begin(std::span<const Target> targets, SolverScratch& scratch);

  // The right-hand side of step 2 (#V) with the rotations of the shape so far. Without `turned`
  // every rotation is 1: the baseline of eq. 1, where the edges exert no force. `room` is that of
  // AddRotatedEdges.
  void Force(bool turned, std::span<Complex> force, std::vector<double>& room);

  // The shape of step 2 from the solution of the rigid factor for that force (#V); empty for no
  // force. Fault: that of a back-substitution.
  Status Rigid(std::span<const Complex> solution, SolverScratch& scratch);

  // Writes the shape to `positions` (#V, units of the mesh) and measures it, or its handles alone.
  // kNumerical when anything is not finite; `positions` is scratch then.
  Result<ShapeQuality> Finish(std::span<const Target> targets, bool measured,
                              std::vector<Complex>& positions);

 private:
  bool IsActive(const VertexRun& run) const {
    return run.component != kNone && set_.roles.active_slot[run.component] != kNone;
  }
  void FitBase();
  void StartFromBase(bool rigid);
  bool Place(std::vector<Complex>& positions);
  void MeasureTriangles(const std::vector<Complex>& positions, ShapeQuality& quality) const;
  void MeasureHandles(std::span<const Target> targets, const std::vector<Complex>& positions,
                      ShapeQuality& quality) const;

  const CompiledHandlesParts& set_;
  const RegisteredMeshParts& mesh_;
  TargetRows targets_;
  std::vector<Complex> shape_;          // #V
  std::vector<Complex> miss_;           // per active row: target minus place
  std::vector<Similarity> base_;        // per component: the similarity that fits its targets best
  std::vector<double> counts_, sizes_;  // per component, of FitBase
  std::vector<Complex> mean_;           // per component: t̄, the rotation of the base
  Crew* crew_ = nullptr;
};

}  // namespace arap
