// Targets: where the client wants its handles, brought into the order of the set.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"

namespace arap::app {

struct NamedTarget {
  std::string_view handle_id;
  Target target;
};

// Moves the named handles in `targets` (one per handle of the set, in its order); the others keep
// theirs. All or nothing. Faults: kUnknownHandle, kDuplicateHandle when one handle is named twice,
// and those of arap::CheckTarget.
Status MergeTargets(const CompiledHandles& handles, std::span<const NamedTarget> named,
                    std::vector<Target>& targets);

// Moves every handle: positions x y x y… in the order of the set; angles and scales stay.
// kTargetCount, kNonFiniteTarget. All or nothing.
Status PackedTargets(const CompiledHandles& handles, std::span<const double> positions,
                     std::vector<Target>& targets);

// One target per handle of the set, in its order. Faults: those of MergeTargets, and kTargetCount
// that names the first handles without a target.
Result<std::vector<Target>> CompleteTargets(const CompiledHandles& handles,
                                            std::span<const NamedTarget> named);

// For the columns of a track: the index in the set of each id; every handle exactly once. Faults:
// kUnknownHandle, kDuplicateHandle, kTargetCount.
Result<std::vector<std::size_t>> CompleteOrder(const CompiledHandles& handles,
                                               std::span<const std::string_view> ids);

}  // namespace arap::app
