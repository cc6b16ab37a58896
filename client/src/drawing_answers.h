// Drawings that a server sent, checked against what was asked.
#pragma once

#include <vector>

#include "arap/base/result.h"
#include "arap/client/flatten.h"

namespace arap::v1 {
class FlattenResponse;
}

namespace arap::client::internal {

// Those that were asked for, each as one file or as the pages of an SVG, whose names are fit for
// names of files. kInternal with a sentence that says what does not fit.
Result<std::vector<Drawing>> DrawingsFromWire(const v1::FlattenResponse& response,
                                              const FlattenQuery& query);

}  // namespace arap::client::internal
