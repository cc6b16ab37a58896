#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "client/cli/adapt.h"
#include "client/cli/load/load_stream.h"
#include "client/cli/sample/grid.h"

namespace arap::cli {

LoadPlan MakeLoadPlan(std::size_t vertices, std::size_t handles,
                      std::chrono::duration<double> length) {
  LoadPlan plan;
  plan.length = length;
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(vertices))));
  const std::size_t columns = std::max<std::size_t>(side, 2);
  const std::size_t rows = std::max<std::size_t>(vertices / columns, 2);
  plan.mesh = ToClient(MakeGrid(columns, rows));
  const double width = static_cast<double>(columns - 1);
  const double height = static_cast<double>(rows - 1);
  plan.reach = 0.1 * std::min(width, height);
  for (std::size_t k = 0; k < handles; ++k) {
    // On a sunflower's spiral: evenly spread for any number of them.
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius =
        0.45 * std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(handles));
    const double x = width * (0.5 + radius * std::cos(golden * static_cast<double>(k)));
    const double y = height * (0.5 + radius * std::sin(golden * static_cast<double>(k)));
    client::Handle& handle = plan.handles.emplace_back();
    handle.id = fmt::format("h{}", k);
    handle.anchor = client::PointAnchor{x, y};
    plan.rests.insert(plan.rests.end(), {x, y});
  }
  return plan;
}

}  // namespace arap::cli
