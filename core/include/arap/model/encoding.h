// How the positions of deformed shapes travel between server and client.
#pragma once

#include <cstdint>
#include <limits>

namespace arap {

// What they are written as when double precision was not asked for. Floats are relative to the middle
// of the shape where that was asked for, integers always: then nothing is lost by being far from 0.
enum class PositionEncoding {
  kFloat32,    // numbers of a repeated field
  kFloat32Le,  // the same as bytes, for languages in which a repeated field is slow to read
  kInt16Le,    // bytes: the longer side of the box around the positions is 2 · kInt16Steps steps
};

// The largest integer of kInt16Le.
inline constexpr std::int16_t kInt16Steps = std::numeric_limits<std::int16_t>::max();

}  // namespace arap
