// A surface laid flat: by one method while a person waits, and by several to compare them.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "arap/client/client.h"
#include "core/drawing/comparison.h"

namespace arap::cli {

// Flattens in double precision with singular values, and checks that the answer fits the mesh. When
// that takes more than a second, a terminal is told what is going on and for how long. Ctrl-C
// cancels the call (kCancelled), a second one ends the program. Not from several threads at once.
Result<client::FlatSurface> FlattenWaiting(const client::Client& client, const SurfaceMesh& mesh,
                                           client::FlattenQuery query,
                                           std::chrono::milliseconds timeout,
                                           const std::string& what);

// The same as a job of the session of that name, which is opened when it is not there: asking
// again, also after Ctrl-C or a failure, finds the job and goes on waiting for it. `timeout` counts
// from what was heard last.
Result<client::FlatSurface> FlattenAsJob(const client::Client& client, const SurfaceMesh& mesh,
                                         client::FlattenQuery query,
                                         std::chrono::milliseconds timeout,
                                         const std::string& session, const std::string& job);

// Flattens with the given options; `what` says which method it is for.
using FlattenCall = std::function<Result<client::FlatSurface>(const client::FlattenQuery& query,
                                                              const std::string& what)>;

// The first step and the two steps as published, face cells refined, least squares conformal,
// angle-based, and injective. Cuts, pins, grain lines and repairs are those of `base`; its method,
// anchors and refinement are not used. A method that fails has a panel that says why; the fault is
// answered only when all fail, or at once when the call was cancelled or came too late.
Result<std::vector<ComparisonPanel>> CompareMethods(const client::FlattenQuery& base,
                                                    const FlattenCall& flatten);

}  // namespace arap::cli
