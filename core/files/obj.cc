#include "core/files/obj.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

#include <CGAL/IO/OBJ.h>
#include <fmt/format.h>

#include "core/files/soup.h"

namespace arap {
namespace {

// CGAL's reader knows faces separated by spaces only, and gives up at elements that are no faces.
std::string Normalized(std::string text) {
  std::replace(text.begin(), text.end(), '\t', ' ');
  std::replace(text.begin(), text.end(), '\r', ' ');
  std::istringstream lines(std::move(text));
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("l ")) out += line + '\n';
  }
  return out;
}

void AppendVertices(std::span<const Point3> vertices, std::string& out) {
  for (const Point3& p : vertices) {
    fmt::format_to(std::back_inserter(out), "v {} {} {}\n", p[0], p[1], p[2]);
  }
}

void AppendFaces(std::span<const Triangle> triangles, std::string& out) {
  for (const Triangle& t : triangles) {
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
}

}  // namespace

Result<SurfaceMesh> ParseObj(std::string text) {
  std::istringstream stream(Normalized(std::move(text)));
  Soup soup;
  const bool read = CGAL::IO::read_OBJ(stream, soup.points, soup.polygons);
  return ToMesh(soup, read, ".obj");
}

std::string FormatObj(const PlanarMesh& mesh) {
  std::string out;
  for (const Complex p : mesh.vertices) {
    fmt::format_to(std::back_inserter(out), "v {} {} 0\n", p.real(), p.imag());
  }
  AppendFaces(mesh.triangles, out);
  return out;
}

std::string FormatObj(const SurfaceMesh& mesh) {
  std::string out;
  AppendVertices(mesh.vertices, out);
  AppendFaces(mesh.triangles, out);
  return out;
}

std::string FormatObj(const SurfaceMesh& mesh, std::span<const Complex> uv,
                      std::span<const Triangle> corner_uv) {
  std::string out;
  AppendVertices(mesh.vertices, out);
  for (const Complex p : uv) {
    fmt::format_to(std::back_inserter(out), "vt {} {}\n", p.real(), p.imag());
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle &v = mesh.triangles[t], &u = corner_uv[t];
    fmt::format_to(std::back_inserter(out), "f {}/{} {}/{} {}/{}\n", v[0] + 1, u[0] + 1, v[1] + 1,
                   u[1] + 1, v[2] + 1, u[2] + 1);
  }
  return out;
}

}  // namespace arap
