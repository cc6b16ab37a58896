#include "client/cli/commands/edit_times.h"

#include <fmt/format.h>

namespace arap::cli {

std::string Describe(const EditTimes& times) {
  std::string text = fmt::format("edit before frame {}: {} removed, {} added in {:.0f} µs",
                                 times.frame, times.removed, times.added, times.solve_micros);
  if (times.round_trip_micros > 0) {
    text += fmt::format(", round trip {:.0f} µs", times.round_trip_micros);
  }
  return text;
}

}  // namespace arap::cli
