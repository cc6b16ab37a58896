// Outlines of fields.
#pragma once

#include <vector>

#include "client/cli/sample/field.h"

namespace arap::cli {

// The closed outline through `start` (which is moved onto it), counter-clockwise, as evenly spaced
// points about `edge` apart. The outline has to be smooth over that length.
std::vector<Point> SampleOutline(const Field& field, Point start, double edge);

}  // namespace arap::cli
