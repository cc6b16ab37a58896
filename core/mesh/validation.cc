#include "core/mesh/validation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/mesh/topology.h"

namespace arap {
namespace {

Status CheckSize(std::size_t vertices, std::size_t triangles, const MeshLimits& limits) {
  if (vertices == 0 || triangles == 0) {
    return Fail(Fault{FaultKind::kEmptyMesh,
                      fmt::format("the mesh has {} vertices and {} triangles; it needs both",
                                  vertices, triangles),
                      {},
                      {},
                      vertices == 0 ? "mesh.vertices" : "mesh.triangles"});
  }
  const auto check = [](const char* what, std::size_t count, std::size_t limit) -> Status {
    if (count <= limit) return {};
    Fault fault{FaultKind::kMeshTooLarge,
                fmt::format("the mesh has {} {}; the limit is {}", count, what, limit),
                {},
                {},
                fmt::format("mesh.{}", what)};
    fault.Detail("count", fmt::to_string(count)).Detail("limit", fmt::to_string(limit));
    return Fail(std::move(fault));
  };
  if (auto ok = check("vertices", vertices, limits.max_vertices); !ok) return ok;
  return check("triangles", triangles, limits.max_triangles);
}

bool Finite(const Complex& p) { return std::isfinite(p.real()) && std::isfinite(p.imag()); }
bool Finite(const Eigen::Vector3d& p) { return p.allFinite(); }

template <class Point>
Status CheckFinite(const std::vector<Point>& points) {
  Fault fault{FaultKind::kNonFiniteCoordinate, "", {}, {}, "mesh.vertices"};
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    if (Finite(points[v])) continue;
    fault.Element(v);
    ++count;
  }
  if (count == 0) return {};
  fault.message = fmt::format("vertex {} has a coordinate that is NaN or infinite ({} in all)",
                              fault.elements.front(), count);
  return Fail(std::move(fault));
}

Status CheckIndices(std::size_t vertices, const std::vector<Triangle>& triangles) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Triangle& c = triangles[t];
    for (const std::uint32_t v : c) {
      if (v < vertices) continue;
      Fault fault{
          FaultKind::kIndexOutOfRange,
          fmt::format("triangle {} names vertex {}, but the mesh has {} vertices", t, v, vertices),
          {t},
          {},
          "mesh.triangles"};
      fault.Detail("vertex", fmt::to_string(v)).Detail("vertices", fmt::to_string(vertices));
      return Fail(std::move(fault));
    }
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      return Fail(
          Fault{FaultKind::kRepeatedIndex,
                fmt::format("triangle {} names a vertex twice: {} {} {}", t, c[0], c[1], c[2]),
                {t},
                {},
                "mesh.triangles"});
    }
  }
  return {};
}

Status CheckDuplicates(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<Triangle, std::uint32_t>> keys;
  keys.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Triangle key = triangles[t];
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, t);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    return Fail(Fault{FaultKind::kDuplicateTriangle,
                      fmt::format("triangles {} and {} have the same vertices", keys[i - 1].second,
                                  keys[i].second),
                      {keys[i - 1].second, keys[i].second},
                      {},
                      "mesh.triangles"});
  }
  return {};
}

Status CheckManifold(const std::vector<Triangle>& triangles) {
  // (v0, v1, triangle), sorted: three in a row on one edge is one too many.
  std::vector<Triangle> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      sides.push_back({low, high, t});
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 2; i < sides.size(); ++i) {
    if (sides[i][0] != sides[i - 2][0] || sides[i][1] != sides[i - 2][1]) continue;
    Fault fault{
        FaultKind::kNonManifoldEdge,
        fmt::format("edge {}-{} belongs to more than two triangles: {}, {}, {}", sides[i][0],
                    sides[i][1], sides[i - 2][2], sides[i - 1][2], sides[i][2]),
        {sides[i - 2][2], sides[i - 1][2], sides[i][2]},
        {},
        "mesh.triangles"};
    fault.Detail("edge", fmt::format("{}-{}", sides[i][0], sides[i][1]));
    return Fail(std::move(fault));
  }
  return {};
}

double Distance(const Complex& a, const Complex& b) { return std::abs(a - b); }
double Distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm(); }

double TwiceArea(const Complex& a, const Complex& b, const Complex& c) {
  return std::imag(std::conj(b - a) * (c - a));
}
double TwiceArea(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b - a).cross(c - a).norm();
}

double Diagonal(const std::vector<Complex>& points, const std::vector<Triangle>& triangles) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  double x0 = kInf, y0 = kInf, x1 = -kInf, y1 = -kInf;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) {
      x0 = std::min(x0, points[v].real()), x1 = std::max(x1, points[v].real());
      y0 = std::min(y0, points[v].imag()), y1 = std::max(y1, points[v].imag());
    }
  }
  return std::hypot(x1 - x0, y1 - y0);
}
double Diagonal(const std::vector<Eigen::Vector3d>& points,
                const std::vector<Triangle>& triangles) {
  Eigen::Vector3d low = points[triangles[0][0]], high = low;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) {
      low = low.cwiseMin(points[v]);
      high = high.cwiseMax(points[v]);
    }
  }
  return (high - low).norm();
}

template <class Point>
Status CheckDegenerate(const std::vector<Point>& points, const std::vector<Triangle>& triangles) {
  Fault fault{FaultKind::kDegenerateTriangle, "", {}, {}, "mesh.triangles"};
  const double smallest = kDegenerateRatio * Diagonal(points, triangles);
  std::size_t count = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Point& a = points[triangles[t][0]];
    const Point& b = points[triangles[t][1]];
    const Point& c = points[triangles[t][2]];
    const double longest = std::max({Distance(a, b), Distance(b, c), Distance(c, a)});
    // Written so that an overflow to infinity or NaN counts as degenerate too.
    const bool good = std::isfinite(longest) && longest > smallest &&
                      std::abs(TwiceArea(a, b, c)) / longest > kDegenerateRatio * longest;
    if (good) continue;
    fault.Element(t);
    ++count;
  }
  if (count == 0) return {};
  fault.message = fmt::format(
      "triangle {} is degenerate: its height is below {} of its longest edge, or it is that small "
      "against the whole mesh ({} in all)",
      fault.elements.front(), kDegenerateRatio, count);
  fault.Detail("limit", fmt::to_string(kDegenerateRatio)).Detail("count", fmt::to_string(count));
  return Fail(std::move(fault));
}

template <class Mesh>
Status CheckAll(const Mesh& mesh, const MeshLimits& limits) {
  if (auto ok = CheckSize(mesh.vertices.size(), mesh.triangles.size(), limits); !ok) return ok;
  if (auto ok = CheckFinite(mesh.vertices); !ok) return ok;
  if (auto ok = CheckIndices(mesh.vertices.size(), mesh.triangles); !ok) return ok;
  if (auto ok = CheckDuplicates(mesh.triangles); !ok) return ok;
  if (auto ok = CheckManifold(mesh.triangles); !ok) return ok;
  return CheckDegenerate(mesh.vertices, mesh.triangles);
}

void Turn(Triangle& t) { std::swap(t[1], t[2]); }

void AddWarning(std::string kind, const std::vector<std::uint32_t>& elements, std::string message,
                std::vector<Warning>& warnings) {
  if (elements.empty()) return;
  Warning warning{std::move(kind), elements.size(), elements, std::move(message)};
  if (warning.elements.size() > Fault::kMaxElements) warning.elements.resize(Fault::kMaxElements);
  warnings.push_back(std::move(warning));
}

void WarnUnreferenced(std::size_t vertices, const std::vector<Triangle>& triangles,
                      std::vector<Warning>& warnings) {
  std::vector<bool> referenced(vertices, false);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) referenced[v] = true;
  }
  std::vector<std::uint32_t> loose;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (!referenced[v]) loose.push_back(v);
  }
  AddWarning(
      "unreferenced_vertices", loose,
      fmt::format("{} vertices belong to no triangle; they stay where they are", loose.size()),
      warnings);
}

void WarnTurned(const std::vector<std::uint32_t>& turned, std::vector<Warning>& warnings) {
  AddWarning("reversed_triangles", turned,
             fmt::format("{} triangles ran the other way round and were turned", turned.size()),
             warnings);
}

bool RunsAlong(const Triangle& t, std::uint32_t from, std::uint32_t to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) ||
         (t[2] == from && t[0] == to);
}

// Walks over each piece from its lowest triangle and turns what runs against it.
Result<std::vector<std::uint32_t>> OrientSurface(std::size_t vertices,
                                                 std::vector<Triangle>& triangles) {
  const Topology topology = BuildTopology(vertices, triangles);
  std::vector<char> seen(triangles.size(), 0);
  std::vector<std::uint32_t> turned, queue;
  for (std::uint32_t start = 0; start < triangles.size(); ++start) {
    if (seen[start]) continue;
    seen[start] = 1;
    queue.assign(1, start);
    while (!queue.empty()) {
      const std::uint32_t t = queue.back();
      queue.pop_back();
      for (const std::uint32_t e : topology.triangle_edges[t]) {
        const Edge& edge = topology.edges[e];
        if (edge.boundary()) continue;
        const std::uint32_t other = edge.triangle[0] == t ? edge.triangle[1] : edge.triangle[0];
        const bool against = RunsAlong(triangles[t], edge.v0, edge.v1) ==
                             RunsAlong(triangles[other], edge.v0, edge.v1);
        if (seen[other]) {
          if (!against) continue;
          return Fail(Fault{FaultKind::kNotOrientable,
                            fmt::format("triangles {} and {} cannot be oriented alike: the surface "
                                        "has one side only",
                                        t, other),
                            {t, other},
                            {},
                            "mesh.triangles"});
        }
        if (against) {
          Turn(triangles[other]);
          turned.push_back(other);
        }
        seen[other] = 1;
        queue.push_back(other);
      }
    }
  }
  std::sort(turned.begin(), turned.end());
  return turned;
}

}  // namespace

Result<std::vector<Warning>> ValidatePlanar(PlanarMesh& mesh, const MeshLimits& limits) {
  if (auto ok = CheckAll(mesh, limits); !ok) return Fail(std::move(ok.error()));
  std::vector<std::uint32_t> turned;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle& c = mesh.triangles[t];
    if (TwiceArea(mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]) > 0) continue;
    Turn(c);
    turned.push_back(t);
  }
  std::vector<Warning> warnings;
  WarnTurned(turned, warnings);
  WarnUnreferenced(mesh.vertices.size(), mesh.triangles, warnings);
  return warnings;
}

Result<std::vector<Warning>> ValidateSurface(SurfaceMesh& mesh, const MeshLimits& limits) {
  if (auto ok = CheckAll(mesh, limits); !ok) return Fail(std::move(ok.error()));
  auto turned = OrientSurface(mesh.vertices.size(), mesh.triangles);
  if (!turned) return Fail(std::move(turned.error()));
  std::vector<Warning> warnings;
  WarnTurned(*turned, warnings);
  WarnUnreferenced(mesh.vertices.size(), mesh.triangles, warnings);
  return warnings;
}

}  // namespace arap
