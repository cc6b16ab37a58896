// Estimates: how much memory and processor time a job will take, before it takes it. Fitted to
// what was measured (docs/operations.md). What a job really holds is counted when it is kept, and
// what it really took when it has ended.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/model/handle.h"

namespace arap {
class CompiledHandles;
}

namespace arap::app {

// Factors and tables of a registration with `vertices`, and what it needs on the way.
std::size_t RegistrationBytes(std::size_t vertices);
// A compilation of `rows` constraint rows.
std::size_t CompilationBytes(std::size_t vertices, std::size_t rows);
// The flattening of `triangles`, at its peak.
std::size_t FlatteningBytes(std::size_t triangles);

// The same in seconds of one thread; all within a factor of two of what was measured.
double RegistrationSeconds(std::size_t vertices);
double CompilationSeconds(std::size_t vertices, std::size_t rows);
// `added` rows to a set of `rows`.
double EditSeconds(std::size_t vertices, std::size_t rows, std::size_t added);
double FlatteningSeconds(std::size_t triangles, std::size_t refine);
// One frame with `refine` iterations; points of a shape to be mapped back.
double FrameSeconds(std::size_t vertices, std::size_t refine);
double PickSeconds(std::size_t vertices, std::size_t picks);
// The drawing order, for those of the handles that have a depth.
double DepthOrderSeconds(const CompiledHandles& set);

// What a request that takes `bytes` counts: small ones do not, so that a frame asks for no memory.
constexpr std::size_t RequestBytes(std::size_t bytes) {
  constexpr std::size_t kSmall = 16u << 10u;
  return bytes > kSmall ? bytes : 0;
}

// What a stream or a track holds beside its handle set, with shapes that wait to be written.
std::size_t LiveSetBytes(std::size_t vertices, std::size_t lanes);

// Constraint rows of handles before they are placed: an area may hold every vertex.
std::size_t RowsOf(const std::vector<Handle>& handles, std::size_t vertices);

}  // namespace arap::app
