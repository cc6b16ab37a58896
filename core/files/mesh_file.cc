#include "core/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include "core/base/try.h"

namespace arap {
namespace {

// What a mesh file holds before anybody has looked whether it is a triangle mesh.
struct Soup {
  std::vector<CGAL::Simple_cartesian<double>::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;
};

// The mesh of a soup. `format` is the ending of the name, for the message when CGAL had not `read`
// it to its end.
Result<SurfaceMesh> ToMesh(const Soup& soup, bool read, std::string_view format) {
  const auto bad = [](std::string what) {
    return Fail(FaultKind::kInvalidOption, std::move(what));
  };
  if (!read) {
    return bad(fmt::format("not a readable {} file; stopped after {} vertices and {} faces", format,
                           soup.points.size(), soup.polygons.size()));
  }
  SurfaceMesh mesh;
  for (const auto& p : soup.points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  for (std::size_t f = 0; f < soup.polygons.size(); ++f) {
    const std::vector<std::size_t>& polygon = soup.polygons[f];
    if (polygon.size() != 3) {
      return bad(fmt::format("not a triangle mesh: face {} has {} corners", f, polygon.size()));
    }
    Triangle& triangle = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      if (polygon[k] >= soup.points.size()) {
        return bad(fmt::format("face {} names a vertex that is not there", f));
      }
      triangle[k] = static_cast<std::uint32_t>(polygon[k]);
    }
  }
  return mesh;
}

// CGAL's reader of OBJ knows faces separated by spaces only, and gives up at elements that are no faces.
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

std::string EndingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

Result<SurfaceMesh> ParseObj(std::string text) {
  std::istringstream stream(Normalized(std::move(text)));
  Soup soup;
  const bool read = CGAL::IO::read_OBJ(stream, soup.points, soup.polygons);
  return ToMesh(soup, read, ".obj");
}

Result<SurfaceMesh> ParseOff(std::string text) {
  std::istringstream stream(std::move(text));
  Soup soup;
  const bool read = CGAL::IO::read_OFF(stream, soup.points, soup.polygons);
  return ToMesh(soup, read, ".off");
}

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

ShapesFile::ShapesFile(const std::string& path, std::size_t vertex_count) : file_(path) {
  std::string header = "frame";
  for (std::size_t v = 0; v < vertex_count; ++v) {
    fmt::format_to(std::back_inserter(header), ",x{0},y{0}", v);
  }
  (void)file_.Write(header + '\n');
}

Status ShapesFile::Write(std::size_t frame, std::span<const Complex> positions) {
  std::string row = fmt::format("{}", frame);
  for (const Complex p : positions) {
    fmt::format_to(std::back_inserter(row), ",{},{}", p.real(), p.imag());
  }
  return file_.Write(row + '\n');
}

}  // namespace arap
