#include "core/mesh/validation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/mesh/defects.h"
#include "core/mesh/gluing.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

Status CheckCount(const char* field, std::size_t count, const char* quota, std::size_t limit) {
  if (count <= limit) return {};
  return Fail(Fault(FaultKind::kMeshTooLarge, fmt::format("{} has {} elements, more than {} of {}.",
                                                          field, count, quota, limit))
                  .Field(field)
                  .Detail("count", count)
                  .Detail("quota", quota)
                  .Detail("limit", limit));
}

Status CheckSize(std::size_t vertices, std::size_t triangles, const MeshLimits& limits) {
  if (vertices == 0 || triangles == 0) {
    return Fail(Fault(FaultKind::kEmptyMesh,
                      fmt::format("The mesh has {} vertices and {} triangles; it needs both.",
                                  vertices, triangles))
                    .Field(vertices == 0 ? "mesh.vertices" : "mesh.triangles"));
  }
  CHECK_OK(CheckCount("mesh.vertices", vertices, "max_vertices", limits.max_vertices));
  return CheckCount("mesh.triangles", triangles, "max_triangles", limits.max_triangles);
}

// False for NaN too.
bool Finite(const Complex& p) {
  return std::abs(p.real()) <= kMaxCoordinate && std::abs(p.imag()) <= kMaxCoordinate;
}
bool Finite(const Point3& p) { return Vec(p).allFinite(); }

// What is wrong with a vertex that is not. The triangles of a surface say themselves when they are
// too large to be measured.
std::string NotFinite(const Complex&) {
  return fmt::format("NaN, infinite or beyond {:g}", kMaxCoordinate);
}
std::string NotFinite(const Point3&) { return "NaN or infinite"; }

template <class Point>
Status CheckFinite(const std::vector<Point>& points) {
  Fault fault = Fault(FaultKind::kNonFiniteCoordinate, "").Field("mesh.vertices");
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    if (Finite(points[v])) continue;
    fault.Element(v);
    ++count;
  }
  if (count == 0) return {};
  fault.message =
      fmt::format("Vertex {} has a coordinate that is {} ({} in all).", fault.elements.front(),
                  NotFinite(points[fault.elements.front()]), count);
  return Fail(std::move(fault));
}

Status CheckIndices(std::size_t vertices, const std::vector<Triangle>& triangles) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Triangle& c = triangles[t];
    for (const std::uint32_t v : c) {
      if (v < vertices) continue;
      return Fail(Fault(FaultKind::kIndexOutOfRange,
                        fmt::format("Triangle {} names vertex {}, but the mesh has {} vertices.", t,
                                    v, vertices))
                      .Field("mesh.triangles")
                      .Element(t)
                      .Detail("vertex", v)
                      .Detail("vertices", vertices));
    }
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      return Fail(
          Fault(FaultKind::kRepeatedIndex,
                fmt::format("Triangle {} has the vertices {}, {} and {}, one of them twice.", t,
                            c[0], c[1], c[2]))
              .Field("mesh.triangles")
              .Element(t));
    }
  }
  return {};
}

Status CheckManifold(std::span<const Side> sides) {
  Status status;
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    if (status && edge.size() > 2) status = Fail(NonManifoldEdgeFault(edge));
  });
  return status;
}

template <class Mesh>
Status CheckBasics(const Mesh& mesh, const MeshLimits& limits) {
  CHECK_OK(CheckSize(mesh.vertices.size(), mesh.triangles.size(), limits));
  CHECK_OK(CheckFinite(mesh.vertices));
  return CheckIndices(mesh.vertices.size(), mesh.triangles);
}

double Distance(const Complex& a, const Complex& b) { return std::abs(a - b); }
double Distance(const Point3& a, const Point3& b) { return (Vec(a) - Vec(b)).norm(); }

template <class Point>
std::vector<std::uint32_t> Degenerate(const std::vector<Point>& points,
                                      const std::vector<Triangle>& triangles) {
  const double smallest = kDegenerateRatio * DiagonalOf(points, triangles);
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Point& a = points[triangles[t][0]];
    const Point& b = points[triangles[t][1]];
    const Point& c = points[triangles[t][2]];
    const double longest = std::max({Distance(a, b), Distance(b, c), Distance(c, a)});
    // Written so that an overflow to infinity or NaN counts as degenerate too.
    const bool good = std::isfinite(longest) && longest > smallest &&
                      std::abs(TwiceArea(a, b, c)) / longest > kDegenerateRatio * longest;
    if (!good) found.push_back(t);
  }
  return found;
}

template <class Mesh>
Status CheckAll(const Mesh& mesh, const MeshLimits& limits, std::vector<Side>& sides) {
  CHECK_OK(CheckBasics(mesh, limits));
  if (sides.empty()) sides = SortedSides(mesh.vertices.size(), mesh.triangles);
  CHECK_OK(CheckDuplicates(mesh.triangles, sides));
  CHECK_OK(CheckManifold(sides));
  const auto degenerate = Degenerate(mesh.vertices, mesh.triangles);
  if (!degenerate.empty()) return Fail(DegenerateFault(degenerate));
  return {};
}

}  // namespace

Status CheckArrays(const SurfaceMesh& mesh, const MeshLimits& limits) {
  return CheckBasics(mesh, limits);
}
Status CheckArrays(const PlanarMesh& mesh, const MeshLimits& limits) {
  return CheckBasics(mesh, limits);
}

Status CheckDuplicates(std::span<const Triangle> triangles, std::span<const Side> sides) {
  const auto opposite = [&](const Side& side) { return triangles[side.triangle()][side.corner()]; };
  Status status;
  std::vector<Side> sorted;
  // Two triangles on the same vertices are two sides of one edge with the same opposite vertex.
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    if (!status || edge.size() < 2) return;
    if (edge.size() == 2 && opposite(edge[0]) != opposite(edge[1])) return;
    sorted.assign(edge.begin(), edge.end());
    std::sort(sorted.begin(), sorted.end(), [&](const Side& a, const Side& b) {
      return opposite(a) != opposite(b) ? opposite(a) < opposite(b) : a.index < b.index;
    });
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      if (opposite(sorted[i]) != opposite(sorted[i - 1])) continue;
      const std::uint32_t a = sorted[i - 1].triangle(), b = sorted[i].triangle();
      const Duplicates all = FindDuplicates(triangles);
      status = Fail(Fault(FaultKind::kDuplicateTriangle,
                          fmt::format("Triangles {} and {} have the same vertices ({} such in all; "
                                      "{}); drop_duplicates leaves one of each.",
                                      a, b, all.pairs.size(), all.WhichWay()))
                        .Field("mesh.triangles")
                        .Elements({a, b})
                        .Detail("count", all.pairs.size()));
      return;
    }
  });
  return status;
}

Fault NonManifoldEdgeFault(std::span<const Side> edge) {
  const std::string name = fmt::format("{}-{}", edge[0].v0, edge[0].v1);
  Fault fault(FaultKind::kNonManifoldEdge,
              fmt::format("Edge {} belongs to more than two triangles: {}, {}, {}{}.", name,
                          edge[0].triangle(), edge[1].triangle(), edge[2].triangle(),
                          edge.size() > 3 ? ", …" : ""));
  for (const Side& side : edge) fault.Element(side.triangle());
  return std::move(fault).Field("mesh.triangles").Detail("edge", name);
}

std::vector<std::uint32_t> DegenerateTriangles(const SurfaceMesh& mesh) {
  return Degenerate(mesh.vertices, mesh.triangles);
}

Fault DegenerateFault(const std::vector<std::uint32_t>& degenerate) {
  return Fault(FaultKind::kDegenerateTriangle,
               fmt::format("Triangle {} is degenerate: its height is below {} of its longest edge, "
                           "or it is that small against the whole mesh ({} in all).",
                           degenerate.front(), kDegenerateRatio, degenerate.size()))
      .Field("mesh.triangles")
      .Elements(degenerate)
      .Detail("limit", kDegenerateRatio)
      .Detail("count", degenerate.size());
}

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

void WarnTurned(const std::vector<bool>& turned, std::vector<Warning>& warnings) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t t = 0; t < turned.size(); ++t) {
    if (turned[t]) ids.push_back(t);
  }
  AddWarning("reversed_triangles", ids,
             fmt::format("{} triangles ran the other way round and were turned", ids.size()),
             warnings);
}

Result<std::vector<Warning>> ValidatePlanar(PlanarMesh& mesh, const MeshLimits& limits) {
  std::vector<Side> sides;
  return ValidatePlanar(mesh, limits, sides);
}

Result<std::vector<Warning>> ValidatePlanar(PlanarMesh& mesh, const MeshLimits& limits,
                                            std::vector<Side>& sides) {
  CHECK_OK(CheckAll(mesh, limits, sides));
  std::vector<bool> turned(mesh.triangles.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle& c = mesh.triangles[t];
    if (TwiceArea(c, mesh.vertices) > 0) continue;
    std::swap(c[1], c[2]);
    turned[t] = true;
  }
  TurnSides(turned, sides);
  std::vector<Warning> warnings;
  WarnTurned(turned, warnings);
  WarnUnreferenced(mesh.vertices.size(), mesh.triangles, warnings);
  return warnings;
}

Result<std::vector<Warning>> ValidateSurface(SurfaceMesh& mesh, const MeshLimits& limits) {
  std::vector<Side> sides;
  CHECK_OK(CheckAll(mesh, limits, sides));
  Gluing gluing = GlueAll(sides);
  TRY(const std::vector<bool> turned, TrianglesToTurn(mesh.triangles, gluing));
  TurnTriangles(turned, mesh.triangles, gluing);
  std::vector<Warning> warnings;
  WarnTurned(turned, warnings);
  WarnUnreferenced(mesh.vertices.size(), mesh.triangles, warnings);
  return warnings;
}

}  // namespace arap
