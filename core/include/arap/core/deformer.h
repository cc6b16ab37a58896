// Deformer: targets in, shape out, once per frame [II09 §4, §6 "interactive update"].
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/crew.h"
#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"
#include "arap/model/deform.h"
#include "arap/model/handle.h"

namespace arap {

struct JointFrame;

// What Update says of a single target, for who keeps targets before they are used: kNonFiniteTarget,
// kInvalidOption (scale), with the field "array[index]…" and the detail "handle_id". Allocates
// nothing for a good one.
Status CheckTarget(const Target& target, std::string_view array, std::size_t index,
                   std::string_view handle_id);

// The mutable scratch of one stream. Not thread-safe; one Deformer per thread or stream, any number
// on one handle set, which it keeps alive. The answer is a function of the targets alone: nothing
// is kept from frame to frame, same targets give the same bytes.
class Deformer {
 public:
  // `lanes` frames may be taken side by side with UpdateMany. Holds about 110 bytes per vertex, and
  // 80 more per lane beyond the first; DeformerBytes (cost.h) tells. std::bad_alloc when it cannot.
  explicit Deformer(std::shared_ptr<const CompiledHandles> handles, std::size_t lanes = 1);
  ~Deformer();
  Deformer(Deformer&&) noexcept;
  Deformer& operator=(Deformer&&) noexcept;

  // One target per handle, in the order of the set. No heap allocation after the first call.
  // Costs O(#V) per constraint row and one back-substitution, which each refinement repeats; about
  // 2 ms at 10,000 vertices. The shape is measured unless options.measure_every is 0; its positions
  // are the same either way.
  //
  // Faults: kTargetCount; kNonFiniteTarget and kInvalidOption (scale) with the field "targets[i]…";
  // kConflictingHandles when hard handles cannot all meet their targets; kInvalidOption for
  // `options.refine`; kNumerical when the shape is not finite; whatever `cancel` answers before each
  // of the 1 + refine steps. positions() is then as before.
  //
  // A crew takes parts of a millisecond at most, of few vertices none; the bytes are the same without
  // one. With one 2 MB more are held.
  Result<ShapeQuality> Update(std::span<const Target> targets, const DeformOptions& options = {},
                              const CancelToken& cancel = {}, Crew* crew = nullptr);

  // Up to lanes() frames at once, the shape and quality of the i-th in lane i; each is the same, to
  // the last bit, as Update's of a Deformer with as many lanes. They share the passes over the
  // factor, which pays for baking. The first fault ends it and leaves all positions as before.
  // They are frames of a track from frame `first` on; options.measure_every counts from frame 0.
  Status UpdateMany(std::span<const std::span<const Target>> frames, const DeformOptions& options,
                    std::span<ShapeQuality> qualities, const CancelToken& cancel = {},
                    std::size_t first = 0, Crew* crew = nullptr);
  std::size_t lanes() const;

  // Vertex positions (#V) of the last successful update, at first the rest positions. Valid until
  // the next call. Unreferenced vertices stay at rest.
  std::span<const Complex> positions(std::size_t lane = 0) const;

  // Ids of the triangles that run clockwise in positions(lane), ascending. Allocates.
  std::vector<std::uint32_t> FlippedTriangles(std::size_t lane = 0) const;

  const std::shared_ptr<const CompiledHandles>& handles() const;

 private:
  friend void UpdateTogether(JointFrame& one, JointFrame& other, Crew* crew);

  class Scratch;
  std::unique_ptr<Scratch> scratch_;
};

// A frame of one Deformer that is computed together with that of another.
struct JointFrame {
  Deformer& deformer;
  std::span<const Target> targets;
  DeformOptions options;
  CancelToken cancel;
  Result<ShapeQuality> quality;  // as Update answers it
};

// Update of two different Deformers at once, in lane 0 of each: where both go through one factor,
// that is read once for both, as for two sets of one mesh that were not factored together with it.
// Each has the bytes and the faults that it has alone, and the fault of one is none of the other's;
// the options need not be equal. No heap allocation once both are warm. After a std::bad_alloc the
// positions of both are as before, or of this update. The crew is that of Update.
void UpdateTogether(JointFrame& one, JointFrame& other, Crew* crew = nullptr);

// Names the factor that UpdateTogether reads once for two sets with the same name. Null where that
// does not pay, because the factor is small. Valid for as long as one of the sets lives.
const void* SharedFactor(const CompiledHandles& handles);

}  // namespace arap
