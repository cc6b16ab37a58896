#include "core/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/files/obj.h"
#include "core/files/off.h"
#include "core/files/text_file.h"

namespace arap {
namespace {

std::string EndingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path) {
  const std::string ending = EndingOf(path);
  if (ending != ".obj" && ending != ".off") {
    return Fail(FaultKind::kInvalidOption,
                path + ": not a mesh file: the name ends neither in .obj nor in .off");
  }
  TRY(std::string text, ReadTextFile(path));
  Result<SurfaceMesh> mesh =
      ending == ".obj" ? ParseObj(std::move(text)) : ParseOff(std::move(text));
  if (!mesh) mesh.error().message = path + ": " + mesh.error().message;
  return mesh;
}

Result<PlanarMesh> ReadPlanarMesh(const std::string& path) {
  TRY(SurfaceMesh surface, ReadSurfaceMesh(path));
  PlanarMesh mesh;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const Point3& p = surface.vertices[v];
    const double z = surface.vertices.front()[2];
    if (p[2] != z) {
      return Fail(FaultKind::kInvalidOption,
                  fmt::format("{}: not in the plane: vertex {} has z = {}, vertex 0 has {}", path,
                              v, p[2], z));
    }
    mesh.vertices.emplace_back(p[0], p[1]);
  }
  mesh.triangles = std::move(surface.triangles);
  return mesh;
}

}  // namespace arap
