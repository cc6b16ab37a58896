// Automatic cuts: every chart made a disk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "core/cut/chart.h"
#include "core/cut/corners.h"
#include "core/mesh/gluing.h"

namespace arap {

// Cuts `gluing` until every chart is a disk. `split` and `charts` belong to it as it comes. Returns
// the lower side of every edge that was cut, ascending. O(#F log #F).
Result<std::vector<std::uint32_t>> CutToDisks(std::span<const Point3> input_vertices,
                                              const SplitVertices& split,
                                              std::span<const Chart> charts, Gluing& gluing,
                                              const CancelToken& cancel);

}  // namespace arap
