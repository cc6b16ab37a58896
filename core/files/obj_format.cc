// Writing OBJ. Apart from reading, which is slow to compile.
#include <iterator>

#include <fmt/format.h>

#include "core/files/mesh_file.h"

namespace arap::cli {
namespace {

void AppendFaces(std::span<const std::uint32_t> triangles, std::string& out) {
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", triangles[t] + 1, triangles[t + 1] + 1,
                   triangles[t + 2] + 1);
  }
}

void AppendVertices(const client::SurfaceMesh& mesh, std::string& out) {
  for (std::size_t i = 0; i + 2 < mesh.vertices.size(); i += 3) {
    fmt::format_to(std::back_inserter(out), "v {} {} {}\n", mesh.vertices[i], mesh.vertices[i + 1],
                   mesh.vertices[i + 2]);
  }
}

}  // namespace

std::string FormatObj(const client::PlanarMesh& mesh) {
  std::string out;
  for (std::size_t i = 0; i + 1 < mesh.vertices.size(); i += 2) {
    fmt::format_to(std::back_inserter(out), "v {} {} 0\n", mesh.vertices[i], mesh.vertices[i + 1]);
  }
  AppendFaces(mesh.triangles, out);
  return out;
}

std::string FormatObj(const client::SurfaceMesh& mesh) {
  std::string out;
  AppendVertices(mesh, out);
  AppendFaces(mesh.triangles, out);
  return out;
}

std::string FormatObj(const client::SurfaceMesh& mesh, std::span<const double> uv,
                      std::span<const std::uint32_t> corner_uv) {
  std::string out;
  AppendVertices(mesh, out);
  for (std::size_t i = 0; i + 1 < uv.size(); i += 2) {
    fmt::format_to(std::back_inserter(out), "vt {} {}\n", uv[i], uv[i + 1]);
  }
  for (std::size_t c = 0; c + 2 < mesh.triangles.size(); c += 3) {
    fmt::format_to(std::back_inserter(out), "f {}/{} {}/{} {}/{}\n", mesh.triangles[c] + 1,
                   corner_uv[c] + 1, mesh.triangles[c + 1] + 1, corner_uv[c + 1] + 1,
                   mesh.triangles[c + 2] + 1, corner_uv[c + 2] + 1);
  }
  return out;
}

}  // namespace arap::cli
