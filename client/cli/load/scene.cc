#include "client/cli/load/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "client/cli/report.h"
#include "client/cli/sample/samples.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"
#include "core/files/plane_fit.h"
#include "core/files/track_file.h"

namespace arap::cli {
namespace {

struct SceneBounds {
  Complex low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Complex high{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
};

SceneBounds BoundsOf(const PlanarMesh& mesh) {
  SceneBounds bounds;
  for (const Complex p : mesh.vertices) {
    bounds.low = {std::min(bounds.low.real(), p.real()), std::min(bounds.low.imag(), p.imag())};
    bounds.high = {std::max(bounds.high.real(), p.real()), std::max(bounds.high.imag(), p.imag())};
  }
  return bounds;
}

void AddHandleAt(const Complex rest, Handle handle, LoadScene& scene) {
  handle.id = fmt::format("h{}", scene.handles.size());
  scene.handles.push_back(std::move(handle));
  scene.rests.push_back(rest);
}

// What follows from the mesh alone.
void FurnishScene(LoadScene& scene) {
  const SceneBounds bounds = BoundsOf(scene.mesh);
  const Complex size = bounds.high - bounds.low;
  scene.reach = 0.1 * std::min(size.real(), size.imag());
  scene.extra.id = "extra";
  constexpr double kThird = 1.0 / 3;
  scene.extra.anchor = TriangleAnchor{static_cast<std::uint32_t>(scene.mesh.triangles.size() / 2),
                                      {kThird, kThird, 1 - 2 * kThird}};
  const double radius = size.real();
  for (const Complex p : scene.mesh.vertices) {
    const double angle = (p.real() - bounds.low.real()) / radius;
    scene.surface.vertices.push_back(
        {radius * std::sin(angle), p.imag(), radius * std::cos(angle)});
  }
  scene.surface.triangles = scene.mesh.triangles;
}

// Each as far as it goes from those before it. O(#V · handles).
Status SpreadHandles(std::size_t count, LoadScene& scene) {
  const std::vector<Complex>& vertices = scene.mesh.vertices;
  // Vertices without a triangle hold nothing.
  std::vector<double> distance(vertices.size(), 0);
  for (const Triangle& triangle : scene.mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v < distance.size()) distance[v] = std::numeric_limits<double>::max();
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (farthest == distance.end() || *farthest <= 0) {
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("The mesh has room for {} handles, not for {}.", k, count))
                      .Field("handles"));
    }
    const auto v = static_cast<std::uint32_t>(farthest - distance.begin());
    Handle handle;
    handle.anchor = VertexAnchor{v};
    AddHandleAt(vertices[v], std::move(handle), scene);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      distance[i] = std::min(distance[i], std::norm(vertices[i] - vertices[v]));
    }
  }
  return {};
}

}  // namespace

LoadScene MakeLoadScene(std::size_t vertices, std::size_t handles) {
  LoadScene scene;
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(vertices))));
  const std::size_t columns = std::max<std::size_t>(side, 2);
  const std::size_t rows = std::max<std::size_t>(vertices / columns, 2);
  scene.mesh = MakeGrid(columns, rows);
  FurnishScene(scene);
  const double width = static_cast<double>(columns - 1);
  const double height = static_cast<double>(rows - 1);
  for (std::size_t k = 0; k < handles; ++k) {
    // On a sunflower's spiral: evenly spread for any number of them.
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius =
        0.45 * std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(handles));
    const double x = width * (0.5 + radius * std::cos(golden * static_cast<double>(k)));
    const double y = height * (0.5 + radius * std::sin(golden * static_cast<double>(k)));
    Handle handle;
    handle.anchor = PointAnchor{{x, y}};
    AddHandleAt({x, y}, std::move(handle), scene);
  }
  return scene;
}

Result<LoadScene> ReadLoadScene(const std::string& mesh_file, std::size_t handles,
                                const std::string& handles_file) {
  LoadScene scene;
  TRY(SurfaceFile file, ReadSurfaceFile(mesh_file));
  PrintWarnings(file.warnings);
  TRY(PlaneFit fit, FitPlane(std::move(file.mesh)));
  PrintWarnings(fit.notes);
  scene.mesh = std::move(fit.mesh);
  if (scene.mesh.triangles.empty()) {
    return Fail(FaultKind::kInvalidOption, mesh_file + " has no triangle.");
  }
  FurnishScene(scene);
  if (handles_file.empty()) {
    CHECK_OK(SpreadHandles(handles, scene));
  } else {
    CHECK_OK(TakeHandles(handles_file, scene));
  }
  return scene;
}

Status TakeHandles(const std::string& handles_file, LoadScene& scene) {
  TRY(const Track track, ReadTrack(handles_file));
  PrintWarnings(track.warnings);
  scene.handles = ToHandles(track, false);
  scene.rests.clear();
  for (const TrackHandle& handle : track.handles) scene.rests.push_back(handle.rest);
  while (std::any_of(scene.handles.begin(), scene.handles.end(),
                     [&](const Handle& handle) { return handle.id == scene.extra.id; })) {
    scene.extra.id += "_";
  }
  return {};
}

std::vector<Complex> TargetsOf(const LoadScene& scene, std::uint64_t seed, std::size_t stream,
                               std::uint64_t step) {
  constexpr double kStepRadians = 0.05;
  const double phase = 2 * std::numbers::pi * DrawPart(seed, Draw::kMotion, stream, 0);
  std::vector<Complex> targets = scene.rests;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const double angle = kStepRadians * static_cast<double>(step) + static_cast<double>(k) + phase;
    targets[k] += scene.reach * Complex(std::sin(angle), 1 - std::cos(angle));
  }
  return targets;
}

}  // namespace arap::cli
