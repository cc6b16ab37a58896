// Estimates: how much memory a job will take, before it takes it. Fitted to measured sizes
// (docs/operations.md) and rounded up; what a job really holds is counted when it is kept.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/model/handle.h"

namespace arap::app {

// Factors and tables of a registration with `vertices`, and what it needs on the way.
std::size_t RegistrationBytes(std::size_t vertices);
// A compilation of `rows` constraint rows.
std::size_t CompilationBytes(std::size_t vertices, std::size_t rows);
// The flattening of `triangles`, at its peak.
std::size_t FlatteningBytes(std::size_t triangles);

// Constraint rows of handles before they are placed: an area may hold every vertex.
std::size_t RowsOf(const std::vector<Handle>& handles, std::size_t vertices);

}  // namespace arap::app
