#include "core/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <vector>

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include "core/files/text_file.h"

namespace arap::cli {
namespace {

using Point3 = CGAL::Simple_cartesian<double>::Point_3;

struct Soup {
  std::vector<Point3> points;
  std::vector<std::vector<std::size_t>> polygons;
};

auto Bad(const std::string& path, const std::string& what) {
  return Fail(FaultKind::kInvalidOption, path + ": " + what);
}

// The OBJ reader knows faces separated by spaces only, and gives up at elements that are no faces.
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

Result<Soup> ReadSoup(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".obj" && ending != ".off") {
    return Bad(path, "not a mesh file: the name ends neither in .obj nor in .off");
  }
  Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error());
  Soup soup;
  bool read = false;
  if (ending == ".obj") {
    std::istringstream stream(Normalized(*std::move(text)));
    read = CGAL::IO::read_OBJ(stream, soup.points, soup.polygons);
  } else {
    std::istringstream stream(*std::move(text));
    read = CGAL::IO::read_OFF(stream, soup.points, soup.polygons);
  }
  if (!read) {
    return Bad(path, fmt::format("not a readable {} file; stopped after {} vertices and {} faces",
                                 ending, soup.points.size(), soup.polygons.size()));
  }
  return soup;
}

}  // namespace

Result<client::SurfaceMesh> ReadSurfaceMesh(const std::string& path) {
  const Result<Soup> soup = ReadSoup(path);
  if (!soup) return Fail(soup.error());
  client::SurfaceMesh mesh;
  for (const Point3& p : soup->points) {
    mesh.vertices.insert(mesh.vertices.end(), {p.x(), p.y(), p.z()});
  }
  for (std::size_t f = 0; f < soup->polygons.size(); ++f) {
    const std::vector<std::size_t>& polygon = soup->polygons[f];
    if (polygon.size() != 3) {
      return Bad(path,
                 fmt::format("not a triangle mesh: face {} has {} corners", f, polygon.size()));
    }
    for (const std::size_t v : polygon) {
      if (v >= soup->points.size()) {
        return Bad(path, fmt::format("face {} names a vertex that is not there", f));
      }
      mesh.triangles.push_back(static_cast<std::uint32_t>(v));
    }
  }
  return mesh;
}

Result<client::PlanarMesh> ReadPlanarMesh(const std::string& path) {
  Result<client::SurfaceMesh> surface = ReadSurfaceMesh(path);
  if (!surface) return Fail(surface.error());
  client::PlanarMesh mesh;
  for (std::size_t v = 0; v < surface->vertex_count(); ++v) {
    const double* const p = &surface->vertices[3 * v];
    if (p[2] != surface->vertices[2]) {
      return Bad(path, fmt::format("not in the plane: vertex {} has z = {}, vertex 0 has {}", v,
                                   p[2], surface->vertices[2]));
    }
    mesh.vertices.insert(mesh.vertices.end(), {p[0], p[1]});
  }
  mesh.triangles = std::move(surface->triangles);
  return mesh;
}

}  // namespace arap::cli
