// One surface laid flat by several methods.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/client/flatten.h"
#include "core/drawing/comparison.h"

namespace arap::cli {

// Flattens with the given options; `what` says which method it is for.
using FlattenCall = std::function<Result<client::FlatSurface>(const client::FlattenQuery& query,
                                                              const std::string& what)>;

// The first step and the two steps as published, face cells refined, least squares conformal,
// angle-based, and injective. Cuts, pins, grain lines and repairs are those of `base`; its method,
// anchors and refinement are not used. A method that fails has a panel that says why; the fault is
// answered only when all fail, or at once when the call was cancelled or came too late.
Result<std::vector<ComparisonPanel>> CompareMethods(const client::FlattenQuery& base,
                                                    const FlattenCall& flatten);

// A line for people with the measures of each panel.
std::string FormatTable(const std::vector<ComparisonPanel>& panels);

}  // namespace arap::cli
