// What a drag says at its end.
#pragma once

#include <span>
#include <string>

#include "client/cli/commands/drag_loop.h"

namespace arap::cli {

// Where each picked point x y x y… was at rest, a line for each: "pick 3,4: rest 1,2 in triangle 7"
// or "pick 9,9: nothing there". `picks` are as many as points.
std::string PickLines(std::span<const double> points, std::span<const client::PickResult> picks);

// All times, edits and picks.
std::string JsonReport(const DragTimes& times, std::span<const double> points);

}  // namespace arap::cli
