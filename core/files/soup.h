// What a mesh file holds before anybody has looked whether it is a triangle mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

struct Soup {
  std::vector<CGAL::Simple_cartesian<double>::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;
};

// The mesh of a soup. `format` is the ending of the name, for the message when CGAL had not `read`
// it to its end.
inline Result<SurfaceMesh> ToMesh(const Soup& soup, bool read, std::string_view format) {
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

}  // namespace arap
