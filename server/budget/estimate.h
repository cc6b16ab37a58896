// Estimates: what the server holds beside the work that the core estimates (arap/core/cost.h).
#pragma once

#include <cstddef>

#include "arap/core/compiled_handles.h"
#include "arap/core/cost.h"

namespace arap::app {

inline double SecondsOf(const Cost& cost) { return cost.milliseconds * 1e-3; }

// What a request that takes `bytes` counts: small ones do not, so that a frame asks for no memory.
constexpr std::size_t RequestBytes(std::size_t bytes) {
  constexpr std::size_t kSmall = 16u << 10u;
  return bytes > kSmall ? bytes : 0;
}

// What a stream or a track holds beside its handle set: the deformer, and three shapes in each lane,
// one computed, one waiting and one being written.
inline std::size_t LiveSetBytes(const CompiledHandles& handles, std::size_t lanes) {
  const std::size_t vertices = handles.mesh()->mesh().vertices.size();
  return DeformerBytes(handles, lanes) + 3 * lanes * vertices * 2 * sizeof(double);
}

}  // namespace arap::app
