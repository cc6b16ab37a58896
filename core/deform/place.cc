#include "core/deform/place.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/mesh/locate.h"

namespace arap {
namespace {

tl::unexpected<Fault> BadOption(std::size_t index, const char* field, std::string message) {
  return Fail(Fault(FaultKind::kInvalidOption, std::move(message))
                  .Field(fmt::format("handles[{}].{}", index, field))
                  .Element(static_cast<std::uint32_t>(index)));
}

Status CheckHandle(const Handle& h, std::size_t index) {
  if (!h.hard && !(h.weight >= Handle::kMinWeight && h.weight <= Handle::kMaxWeight)) {
    return BadOption(index, "weight",
                     fmt::format("handle \"{}\" has weight {}; it must be {} to {}", h.id, h.weight,
                                 Handle::kMinWeight, Handle::kMaxWeight));
  }
  if (!(h.area_radius >= 0 && std::isfinite(h.area_radius))) {
    return BadOption(
        index, "area_radius",
        fmt::format("handle \"{}\" has area radius {}; it must be finite and at least 0", h.id,
                    h.area_radius));
  }
  if (!(std::abs(h.depth) <= Handle::kMaxDepth)) {
    return BadOption(index, "depth",
                     fmt::format("handle \"{}\" has depth {}; it must be from {} to {}", h.id,
                                 h.depth, -Handle::kMaxDepth, Handle::kMaxDepth));
  }
  if (!(h.depth_falloff >= 0 && std::isfinite(h.depth_falloff))) {
    return BadOption(index, "depth_falloff",
                     fmt::format("handle \"{}\" has depth falloff {}; it must be finite and at "
                                 "least 0",
                                 h.id, h.depth_falloff));
  }
  return {};
}

// Where a handle sits: a triangle and barycentric weights (a vertex: its first triangle, one weight
// 1).
struct Seat {
  std::uint32_t triangle = kNone;
  std::array<double, 3> barycentric{};
  double snapped = 0;  // normalised
};

tl::unexpected<Fault> OutOfRange(const char* what, std::uint32_t id, std::size_t count,
                                 const Handle& handle, std::size_t index) {
  return Fail(Fault(FaultKind::kIndexOutOfRange,
                    fmt::format("handle \"{}\" is on {} {}, but the mesh has {}", handle.id, what,
                                id, count))
                  .Field(fmt::format("handles[{}]", index))
                  .Element(static_cast<std::uint32_t>(index))
                  .Detail(what, fmt::to_string(id))
                  .Detail("count", fmt::to_string(count)));
}

Result<Seat> SitOn(const RegisteredMeshParts& mesh, const VertexAnchor& anchor,
                   const Handle& handle, std::size_t index) {
  if (anchor.vertex >= mesh.rest.size()) {
    return OutOfRange("vertex", anchor.vertex, mesh.rest.size(), handle, index);
  }
  const auto& triangles = mesh.mesh.triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangles[t][k] != anchor.vertex) continue;
      Seat seat{t, {}, 0};
      seat.barycentric[k] = 1;
      return seat;
    }
  }
  return Fail(Fault(FaultKind::kHandleOutside,
                    fmt::format("handle \"{}\" is on vertex {}, which belongs to no triangle",
                                handle.id, anchor.vertex))
                  .Field(fmt::format("handles[{}].vertex", index))
                  .Element(static_cast<std::uint32_t>(index))
                  .Detail("vertex", fmt::to_string(anchor.vertex)));
}

Result<Seat> SitOn(const RegisteredMeshParts& mesh, const TriangleAnchor& anchor,
                   const Handle& handle, std::size_t index) {
  const std::size_t count = mesh.mesh.triangles.size();
  if (anchor.triangle >= count)
    return OutOfRange("triangle", anchor.triangle, count, handle, index);
  std::array<double, 3> b = anchor.barycentric;
  double sum = 0;
  bool good = true;
  for (const double x : b) {
    good = good && x >= -1e-6 && x <= 1 + 1e-6;
    sum += x;
  }
  if (!good || !(std::abs(sum - 1) <= 1e-6)) {
    return BadOption(
        index, "triangle_point.barycentric",
        fmt::format("handle \"{}\" has barycentric weights {} {} {}; each must be 0 to 1, "
                    "their sum 1 ± 1e-6",
                    handle.id, b[0], b[1], b[2]));
  }
  // Exactly 1, or a rigid motion far from the origin would not be exact.
  for (double& x : b) x = x / sum;
  if (mesh.turned[anchor.triangle]) std::swap(b[1], b[2]);
  return Seat{anchor.triangle, b, 0};
}

Result<Seat> SitOn(const RegisteredMeshParts& mesh, const PointAnchor& anchor, const Handle& handle,
                   std::size_t index) {
  const Complex p = mesh.Normalise(anchor.position);
  if (!std::isfinite(p.real()) || !std::isfinite(p.imag())) {
    return BadOption(
        index, "position",
        fmt::format("handle \"{}\" has a position that is NaN or infinite", handle.id));
  }
  if (const auto found = Locate(mesh.rest, mesh.mesh.triangles, p)) {
    return Seat{found->triangle, found->barycentric, 0};
  }
  const Located near = NearestOnBoundary(mesh.rest, mesh.mesh.triangles, mesh.topology, p);
  if (handle.outside == Outside::kSnap) {
    return Seat{near.triangle, near.barycentric, near.distance};
  }
  const double distance = near.distance * mesh.report.diagonal;
  return Fail(Fault(FaultKind::kHandleOutside,
                    fmt::format("handle \"{}\" at ({}, {}) lies outside the mesh by {}", handle.id,
                                anchor.position.real(), anchor.position.imag(), distance))
                  .Field(fmt::format("handles[{}].position", index))
                  .Element(static_cast<std::uint32_t>(index))
                  .Detail("distance", fmt::to_string(distance)));
}

Row VertexRow(const RegisteredMeshParts& mesh, std::uint32_t vertex) {
  return {0, {vertex, vertex, vertex}, {1, 0, 0}, mesh.rest[vertex], {}, 0, 0};
}

// The vertices that an oriented or area handle holds: those of its triangle, and those of its
// component within the radius.
std::vector<std::uint32_t> HeldVertices(const RegisteredMeshParts& mesh, std::uint32_t triangle,
                                        Complex rest, double radius) {
  const Triangle& t = mesh.mesh.triangles[triangle];
  std::vector<std::uint32_t> held(t.begin(), t.end());
  const std::uint32_t component = mesh.topology.vertex_component[t[0]];
  if (radius > 0) {
    for (std::uint32_t v = 0; v < mesh.rest.size(); ++v) {
      if (mesh.topology.vertex_component[v] == component &&
          std::abs(mesh.rest[v] - rest) <= radius) {
        held.push_back(v);
      }
    }
  }
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());
  return held;
}

}  // namespace

Result<Placement> PlaceHandle(const RegisteredMeshParts& mesh, const Handle& handle,
                              std::size_t index) {
  if (auto ok = CheckHandle(handle, index); !ok) return Fail(std::move(ok.error()));
  auto seat =
      std::visit([&](const auto& a) { return SitOn(mesh, a, handle, index); }, handle.anchor);
  if (!seat) return Fail(std::move(seat.error()));

  const Triangle& corners = mesh.mesh.triangles[seat->triangle];
  Complex rest = 0;
  for (std::size_t k = 0; k < 3; ++k) rest += seat->barycentric[k] * mesh.rest[corners[k]];

  Placement placement;
  if (handle.oriented || handle.area_radius > 0) {
    const double radius = handle.area_radius / mesh.report.diagonal;
    for (const std::uint32_t v : HeldVertices(mesh, seat->triangle, rest, radius)) {
      placement.rows.push_back(VertexRow(mesh, v));
    }
  } else {
    placement.rows.push_back({0, corners, seat->barycentric, rest, {}, 0, 0});
  }
  const std::uint32_t component = mesh.topology.vertex_component[corners[0]];
  for (Row& row : placement.rows) {
    row.offset = row.rest - rest;
    row.compliance = handle.hard ? 0 : 1 / handle.weight;
    row.component = component;
  }
  // A vertex answers with its own coordinates to the last bit.
  const auto* on_vertex = std::get_if<VertexAnchor>(&handle.anchor);
  const Complex shown =
      on_vertex ? mesh.mesh.vertices[on_vertex->vertex] : mesh.origin + mesh.report.diagonal * rest;
  placement.placed = {handle, shown, seat->snapped * mesh.report.diagonal, component};
  return placement;
}

}  // namespace arap
