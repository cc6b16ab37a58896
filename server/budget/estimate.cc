#include "server/budget/estimate.h"

#include <algorithm>
#include <cmath>

#include "arap/core/compiled_handles.h"

namespace arap::app {
namespace {

// Nested dissection fills a factor with n log n numbers.
double FactorBytes(double vertices) { return vertices * (400 + 140 * std::log2(vertices + 1)); }

// Of numbers that outgrow the caches: a pass over `vertices` takes so much longer for each.
double Slower(std::size_t vertices, double by) {
  constexpr double kFits = 1e5;
  return 1 + by * static_cast<double>(vertices) / kFits;
}

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

double RegistrationSeconds(std::size_t vertices) {
  const auto n = static_cast<double>(vertices);
  return 1e-4 + 7e-6 * n + 3.6e-8 * n * std::sqrt(n);
}

double CompilationSeconds(std::size_t vertices, std::size_t rows) {
  if (rows > kDirectRows) return RegistrationSeconds(vertices);
  return 1e-4 + 8e-8 * static_cast<double>(vertices * rows) * Slower(vertices, 1);
}

double EditSeconds(std::size_t vertices, std::size_t rows, std::size_t added) {
  if (rows + added > kDirectRows) return RegistrationSeconds(vertices);
  return CompilationSeconds(vertices, added) + 1.4e-7 * static_cast<double>(vertices);
}

double FlatteningSeconds(std::size_t triangles, std::size_t refine) {
  const auto n = static_cast<double>(triangles);
  return 1e-4 + n * (5e-6 + 2.5e-7 * static_cast<double>(refine)) * Slower(triangles, 0.03);
}

double FrameSeconds(std::size_t vertices, std::size_t refine) {
  const double passes = 1 + 0.6 * static_cast<double>(refine);
  return 2e-5 + 1.3e-7 * static_cast<double>(vertices) * passes * Slower(vertices, 0.5);
}

double PickSeconds(std::size_t vertices, std::size_t picks) {
  return 1e-8 * static_cast<double>(vertices) * static_cast<double>(picks);
}

double DepthOrderSeconds(const CompiledHandles& set) {
  const auto deep =
      std::count_if(set.handles().begin(), set.handles().end(),
                    [](const PlacedHandle& handle) { return handle.handle.depth != 0; });
  return 2e-7 * static_cast<double>(set.mesh()->mesh().vertices.size()) * static_cast<double>(deep);
}

std::size_t LiveSetBytes(std::size_t vertices, std::size_t lanes) {
  // The deformer's numbers, and three shapes: computed, waiting, being written.
  return vertices * lanes * (124 + 3 * 2 * sizeof(double));
}

std::size_t RowsOf(const std::vector<Handle>& handles, std::size_t vertices) {
  std::size_t rows = 0;
  for (const Handle& handle : handles) {
    const std::size_t held = handle.oriented ? 3 : 1;
    rows += handle.area_radius > 0 ? vertices : held;
  }
  return rows;
}

}  // namespace arap::app
