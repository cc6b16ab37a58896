#include "tests/bench/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include "client/cli/sample/samples.h"
#include "tests/support/meshes.h"

namespace arap::bench {
namespace {

constexpr std::size_t kHandles = 8;
constexpr std::size_t kPoses = 16;
constexpr double kReach = 0.06;  // radius of the handles' circles, of the mesh's diagonal

Complex Centroid(const PlanarMesh& mesh, const Triangle& t) {
  return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
}

double Diagonal(const PlanarMesh& mesh) {
  Complex low = mesh.vertices[0], high = low;
  for (const Complex p : mesh.vertices) {
    low = {std::min(low.real(), p.real()), std::min(low.imag(), p.imag())};
    high = {std::max(high.real(), p.real()), std::max(high.imag(), p.imag())};
  }
  return std::abs(high - low);
}

// Triangles, each as far as possible from those before it.
std::vector<std::uint32_t> SpreadTriangles(const PlanarMesh& mesh, std::size_t count) {
  std::vector<double> distance(mesh.triangles.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> chosen{0};
  while (chosen.size() < count) {
    const Complex last = Centroid(mesh, mesh.triangles[chosen.back()]);
    for (std::size_t t = 0; t < distance.size(); ++t) {
      distance[t] = std::min(distance[t], std::abs(Centroid(mesh, mesh.triangles[t]) - last));
    }
    const auto farthest = std::ranges::max_element(distance) - distance.begin();
    chosen.push_back(static_cast<std::uint32_t>(farthest));
  }
  return chosen;
}

Scene SceneOf(std::string name, PlanarMesh mesh) {
  Scene scene{std::move(name), std::move(mesh), {}, {}, {}};
  for (const std::uint32_t triangle : SpreadTriangles(scene.mesh, kHandles + 1)) {
    Handle handle;
    handle.id = std::string("h").append(std::to_string(scene.handles.size()));
    handle.anchor = TriangleAnchor{triangle, {0.5, 0.3, 0.2}};
    scene.handles.push_back(std::move(handle));
  }
  scene.extra = std::move(scene.handles.back());
  scene.handles.pop_back();

  const double radius = kReach * Diagonal(scene.mesh);
  for (std::size_t p = 0; p < kPoses; ++p) {
    auto& pose = scene.poses.emplace_back();
    for (std::size_t h = 0; h < kHandles; ++h) {
      const Hold hold = HoldOf(scene, scene.handles[h]);
      Complex rest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        rest += hold.weights[k] * scene.mesh.vertices[hold.vertices[k]];
      }
      const double turn =
          2 * std::numbers::pi * static_cast<double>(p) / kPoses + static_cast<double>(h);
      pose.push_back(rest + std::polar(radius, turn));
    }
  }
  return scene;
}

}  // namespace

Hold HoldOf(const Scene& scene, const Handle& handle) {
  const auto& anchor = std::get<TriangleAnchor>(handle.anchor);
  return {scene.mesh.triangles[anchor.triangle], anchor.barycentric};
}

Scene GridScene(std::size_t vertices) {
  const auto side =
      static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(vertices)))) - 1;
  return SceneOf("grid", testing::JitteredGrid(side, side, 1));
}

Scene CharacterScene(std::size_t vertices) {
  // Its area is 16 680 square units; a vertex takes two equilateral triangles.
  const double edge = std::sqrt(2 * 16680 / (std::numbers::sqrt3 * static_cast<double>(vertices)));
  return SceneOf("character", cli::MakeCharacter(edge));
}

}  // namespace arap::bench
