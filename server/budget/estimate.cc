#include "server/budget/estimate.h"

#include <algorithm>
#include <cmath>

#include "arap/core/compiled_handles.h"

namespace arap::app {
namespace {

// Nested dissection fills a factor with n log n numbers.
double FactorBytes(double vertices) { return vertices * (400 + 140 * std::log2(vertices + 1)); }

// Beside the result: the matrix, its analysis, the mesh.
constexpr double kWorking = 1.5;

}  // namespace

std::size_t RegistrationBytes(std::size_t vertices) {
  return static_cast<std::size_t>(kWorking * FactorBytes(static_cast<double>(vertices)));
}

std::size_t CompilationBytes(std::size_t vertices, std::size_t rows) {
  // Above it both matrices are factored anew; below, three numbers per vertex and row are kept.
  if (rows > kDirectRows) return RegistrationBytes(vertices);
  return vertices * rows * 3 * sizeof(double) + rows * rows * 6 * sizeof(double);
}

std::size_t FlatteningBytes(std::size_t triangles) { return triangles * 1'200; }

std::size_t RowsOf(const std::vector<Handle>& handles, std::size_t vertices) {
  std::size_t rows = 0;
  for (const Handle& handle : handles) {
    const std::size_t held = handle.oriented ? 3 : 1;
    rows += handle.area_radius > 0 ? vertices : held;
  }
  return rows;
}

}  // namespace arap::app
