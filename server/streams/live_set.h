// LiveSet: the handle set of one stream with its targets and its shape.
#pragma once

#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/deformer.h"
#include "server/budget/limits.h"
#include "server/sessions/entries.h"

namespace arap::app {

// Not thread-safe. Starts from a copy of what the session holds; edits change this set only, so
// that one stream's pins never move another stream's shape.
class LiveSet {
 public:
  explicit LiveSet(HandleSetEntry entry);

  const HandleSetEntry& entry() const { return entry_; }
  const CompiledHandles& handles() const { return *entry_.handles; }
  Deformer& deformer() { return deformer_; }
  // The last target of each handle, at first where it rests.
  std::vector<Target>& targets() { return targets_; }

  // The set after an edit, its shape computed and its quality in `quality`. Handles that stay keep
  // their targets; an added one starts where the current shape has it. This set is not changed.
  // Faults: those of EditEntry and of Deformer::Update.
  Result<LiveSet> Edited(const std::vector<std::string>& remove, const std::vector<Handle>& add,
                         const DeformOptions& options, const Limits& limits,
                         const CancelToken& cancel, ShapeQuality& quality) const;

 private:
  HandleSetEntry entry_;
  std::vector<Target> targets_;
  Deformer deformer_;
};

}  // namespace arap::app
