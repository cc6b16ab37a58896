#include "core/flatten/injective/tutte.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/try.h"
#include "core/flatten/distortion.h"
#include "core/mesh/space.h"
#include "core/sparse/factor.h"
#include "core/sparse/lower_sum.h"

namespace arap {
namespace {

constexpr double kLeastCotangent = 1e-2;
constexpr double kLeastArc = 1e-3;  // of a boundary edge, as a part of the mean

struct Spring {
  std::uint32_t a, b;
  double weight;
};

std::vector<Spring> Springs(const SurfaceMesh& mesh, TutteWeights weights,
                            const std::vector<bool>& left_out) {
  std::vector<Spring> springs;
  springs.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    const bool known = left_out.empty() || !left_out[t];
    std::array<Complex, 3> flat{};
    if (known && weights == TutteWeights::kCotangent) flat = LayFlat(mesh, triangle);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      double weight = kLeastCotangent;
      if (weights == TutteWeights::kUniform) {
        weight = 1;
      } else if (known) {
        const Complex corner = std::conj(flat[i] - flat[k]) * (flat[j] - flat[k]);
        weight = std::max(weight, corner.real() / corner.imag());
      }
      springs.push_back({triangle[i], triangle[j], weight});
    }
  }
  return springs;
}

// Places a loop on the unit circle.
void OnCircle(const SurfaceMesh& mesh, const std::vector<std::uint32_t>& loop,
              std::vector<Complex>& uv) {
  std::vector<double> arc;
  double total = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    arc.push_back(
        (Vec(mesh.vertices[loop[(k + 1) % loop.size()]]) - Vec(mesh.vertices[loop[k]])).norm());
    total += arc.back();
  }
  const double least = kLeastArc * total / static_cast<double>(loop.size());
  total = 0;
  for (double& length : arc) total += length = std::max(length, least);
  double along = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    uv[loop[k]] = std::polar(1.0, 2 * std::numbers::pi * along / total);
    along += arc[k];
  }
}

}  // namespace

Result<std::vector<Complex>> TutteEmbedding(const SurfaceMesh& mesh,
                                            std::span<const std::vector<std::uint32_t>> loops,
                                            TutteWeights weights,
                                            const std::vector<bool>& left_out) {
  const std::size_t vertices = mesh.vertices.size();
  std::vector<Spring> springs = Springs(mesh, weights, left_out);
  std::size_t n = vertices;
  for (const auto& hole : loops.subspan(1)) {
    for (const std::uint32_t v : hole) springs.push_back({static_cast<std::uint32_t>(n), v, 1});
    ++n;
  }
  std::vector<Complex> uv(n, 0);
  OnCircle(mesh, loops[0], uv);
  std::vector<bool> known(n, false);
  for (const std::uint32_t v : loops[0]) known[v] = true;
  // Nothing holds a vertex whose triangles are all left out: it stays at 0.
  std::vector<bool> fixed(n, true);
  for (const Spring& s : springs) fixed[s.a] = fixed[s.b] = false;
  for (const std::uint32_t v : loops[0]) fixed[v] = true;
  std::vector<double> right(2 * n, 0);
  LowerSum<double> sum(fixed);
  for (const Spring& s : springs) sum.Count(s.a, s.b);
  sum.EndOfCounting();
  for (const Spring& s : springs) {
    sum.Add(s.a, s.a, s.weight);
    sum.Add(s.b, s.b, s.weight);
    sum.Add(std::max(s.a, s.b), std::min(s.a, s.b), -s.weight);
    if (fixed[s.a] == fixed[s.b]) continue;
    const std::uint32_t free = fixed[s.a] ? s.b : s.a, held = fixed[s.a] ? s.a : s.b;
    right[free] += s.weight * uv[held].real();
    right[n + free] += s.weight * uv[held].imag();
  }
  for (std::size_t v = 0; v < n; ++v) {
    if (!fixed[v]) continue;
    right[v] = uv[v].real();
    right[n + v] = uv[v].imag();
  }
  TRY(const auto factor, Factor<double>::Make(sum.Take(), FactorLayout::kSupernodal));
  Workspace workspace;
  TRY(const auto solution, factor->Solve(right, 2, workspace));
  uv.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) uv[v] = {solution[v], solution[n + v]};
  return uv;
}

}  // namespace arap
