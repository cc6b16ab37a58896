// LiveSet: a handle set with its shape, as a stream or a single call moves it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/deformer.h"
#include "arap/model/limits.h"
#include "server/sessions/handle_sets.h"

namespace arap::runtime {
class Metrics;
}

namespace arap::app {

struct EditedSet;

// Not thread-safe. Starts from what the session holds; edits make another set and leave the
// session's as it is, so that one stream's pins never move another stream's shape.
class LiveSet {
 public:
  // At rest until it is moved. With `lanes` it holds as many shapes, see Deformer.
  explicit LiveSet(HandleSetEntry entry, std::size_t lanes = 1);

  // What it holds beside its handle set, with what a call has under way: the deformer, and three
  // shapes in each lane, one computed, one waiting and one being written.
  static std::size_t BytesOf(const CompiledHandles& handles, const DeformOptions& options,
                             std::size_t lanes);

  const HandleSetEntry& entry() const { return entry_; }
  const Deformer& deformer() const { return deformer_; }

  // Computes the shape for one target per handle; in a thread of the job lane, where the frame takes longer than
  // kLongFrameSeconds, with help of those of the interactive lane. Faults: those of Deformer::Update.
  Result<ShapeQuality> Move(std::span<const Target> targets, const DeformOptions& options,
                            runtime::Metrics& metrics, const CancelToken& cancel);

  // The processor time that other threads took for the last Move (runtime/helpers.h).
  double helped_seconds() const { return helped_seconds_; }

  // The same for several shapes at once, one per lane at most: frames of a track, from `first` on.
  Status MoveMany(std::span<const std::span<const Target>> targets, const DeformOptions& options,
                  std::span<ShapeQuality> qualities, std::size_t first, runtime::Metrics& metrics,
                  const CancelToken& cancel);

  // The same for two sets at once, see UpdateTogether: each has the shape and the faults that Move
  // gives it. MoveTogether answers the processor time that other threads took for both.
  JointFrame FrameOf(std::span<const Target> targets, const DeformOptions& options,
                     CancelToken cancel) {
    return {deformer_, targets, options, std::move(cancel), {}};
  }
  static double MoveTogether(JointFrame& one, JointFrame& other, runtime::Metrics& metrics);

  // The set after an edit, its shape computed. `targets` are the last ones of this set: handles
  // that stay keep theirs, an added one starts where the current shape has it. This set is not
  // changed, and the shape is always measured. Faults: those of EditEntry and of Deformer::Update.
  Result<EditedSet> Edited(const std::vector<std::string>& remove, const std::vector<Handle>& add,
                           std::span<const Target> targets, const DeformOptions& options,
                           const Limits& limits, const CancelToken& cancel,
                           runtime::Metrics& metrics) const;

 private:
  HandleSetEntry entry_;
  Deformer deformer_;
  double helped_seconds_ = 0;
};

struct EditedSet {
  LiveSet set;
  std::vector<Target> targets;  // one per handle of the set
  ShapeQuality quality;
};

// For each handle the target that leaves the shape as it is: its rest point carried along by
// `positions` (#V), and the rotation and scale of its triangle. Where triangles overlap at rest, the
// handle's own anchor decides, for anchors by point the lowest index. O(#F) for all together, once
// for anchors by vertex and once for those by point, and O(log #F) for each.
std::vector<Target> PosesOf(const RegisteredMesh& mesh, std::span<const PlacedHandle> handles,
                            std::span<const Complex> positions);

}  // namespace arap::app
