// One flattening, waited for by a person.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "arap/client/client.h"

namespace arap::cli {

// Flattens in double precision with singular values, and checks that the answer fits the mesh. When
// that takes more than a second, a terminal is told what is going on and for how long. Ctrl-C
// cancels the call (kCancelled), a second one ends the program. Not from several threads at once.
Result<client::FlatSurface> FlattenWaiting(const client::Client& client, const SurfaceMesh& mesh,
                                           client::FlattenQuery query,
                                           std::optional<std::chrono::milliseconds> timeout,
                                           const std::string& what);

// kInternal unless every index and length of the answer is as flatten.h says: an answer of another
// shape must not make us read past it.
Status CheckAnswer(const SurfaceMesh& mesh, const Flattening& flat);

}  // namespace arap::cli
