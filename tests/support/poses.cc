#include "tests/support/poses.h"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <numeric>

#include "tests/support/compare.h"
#include "tests/support/random.h"

namespace arap::testing {

Handle AtVertex(std::uint32_t vertex) { return AtVertex("v" + std::to_string(vertex), vertex); }

Handle AtVertex(std::string id, std::uint32_t vertex) {
  return {std::move(id), VertexAnchor{vertex}};
}

TextbookHandle OnVertex(std::uint32_t vertex, double weight) {
  return {{vertex, vertex, vertex}, {1, 0, 0}, weight};
}

std::vector<TextbookHandle> RandomVertexHandles(const PlanarMesh& mesh, std::size_t count,
                                                std::uint64_t seed, double weight) {
  std::vector<std::uint32_t> used;
  for (const Triangle& t : mesh.triangles) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  assert(count <= used.size());
  Random(seed).Shuffle(used);
  std::vector<TextbookHandle> handles;
  for (std::size_t h = 0; h < count; ++h) handles.push_back(OnVertex(used[h], weight));
  return handles;
}

std::vector<TextbookHandle> RandomInnerHandles(const PlanarMesh& mesh, std::size_t count,
                                               std::uint64_t seed, double weight) {
  Random random(seed);
  std::vector<std::uint32_t> triangles(mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0U);
  assert(count <= triangles.size());
  random.Shuffle(triangles);
  std::vector<TextbookHandle> handles;
  for (std::size_t h = 0; h < count; ++h) {
    const double a = random.Uniform(0.1, 0.8);
    const double b = (1 - a) * random.Uniform(0.1, 0.9);
    handles.push_back({mesh.triangles[triangles[h]], {a, b, 1 - a - b}, weight});
  }
  return handles;
}

std::vector<Complex> RestTargets(const PlanarMesh& mesh, std::span<const TextbookHandle> handles) {
  std::vector<Complex> rest;
  for (const TextbookHandle& handle : handles) {
    Complex point;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      point += handle.weights[corner] * mesh.vertices[handle.vertices[corner]];
    }
    rest.push_back(point);
  }
  return rest;
}

std::vector<Complex> RandomPose(const PlanarMesh& mesh, std::span<const Complex> rest,
                                double spread, std::uint64_t seed) {
  Random random(seed);
  const double diagonal = Diagonal(mesh.vertices);
  const Complex centre =
      std::accumulate(rest.begin(), rest.end(), Complex()) / static_cast<double>(rest.size());
  const Complex turn = std::polar(1.0, random.Uniform(-std::numbers::pi, std::numbers::pi));
  const auto offset = [&](double reach) {
    const double x = random.Uniform(-reach, reach);
    const double y = random.Uniform(-reach, reach);
    return Complex(x, y);
  };
  const Complex shift = offset(diagonal);
  std::vector<Complex> pose;
  for (const Complex& p : rest) {
    pose.push_back(centre + turn * (p - centre) + shift + offset(spread * diagonal));
  }
  return pose;
}

}  // namespace arap::testing
