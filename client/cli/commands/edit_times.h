// How long a change of the handles took.
#pragma once

#include <cstddef>
#include <string>

namespace arap::cli {

struct EditTimes {
  std::size_t frame = 0;  // done before this one
  std::size_t removed = 0;
  std::size_t added = 0;
  double queue_micros = 0;
  double solve_micros = 0;
  double round_trip_micros = 0;  // 0: not taken
};

// "edit before frame 60: 1 removed, 2 added in 83 µs".
std::string Describe(const EditTimes& times);

}  // namespace arap::cli
