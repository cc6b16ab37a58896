#include "core/deform/place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "arap/core/cost.h"
#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/deform/registered_parts.h"
#include "core/mesh/locate.h"

namespace arap {
namespace {

constexpr double kBarycentricTolerance = 1e-6;
// Handles so little outside the mesh count as on its border: files round what they hold. Normalised.
constexpr double kBorderTolerance = 1e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A handle with its place in the request, for faults: "handles[3]", "add[0]".
struct Named {
  const Handle& handle;
  std::string_view array;
  std::size_t index;

  std::string Field(std::string_view part = {}) const {
    return fmt::format("{}[{}]{}{}", array, index, part.empty() ? "" : ".", part);
  }
  Fault Bad(FaultKind kind, std::string field, std::string sentence) const {
    return Fault(kind, std::move(sentence))
        .Field(std::move(field))
        .Element(static_cast<std::uint32_t>(index));
  }
  // Finite and from `low` to `high`, infinite where there is no such bound.
  Status CheckRange(std::string_view part, double value, double low, double high) const {
    if (std::isfinite(value) && value >= low && value <= high) return {};
    std::string sentence = fmt::format("{} is {}, but must be finite", Field(part), value);
    if (std::isfinite(low)) sentence += fmt::format(", at least {}", low);
    if (std::isfinite(high)) sentence += fmt::format(", at most {}", high);
    return Fail(Bad(FaultKind::kInvalidOption, Field(part), sentence + ".").Detail("value", value));
  }
};

Status CheckAnchor(const VertexAnchor&, const Named&) { return {}; }

Status CheckAnchor(const TriangleAnchor& anchor, const Named& named) {
  const std::string field = named.Field("triangle_point.barycentric");
  double sum = 0;
  for (const double x : anchor.barycentric) {
    // Written so that NaN fails too.
    if (!(x >= -kBarycentricTolerance && x <= 1 + kBarycentricTolerance)) {
      return Fail(named
                      .Bad(FaultKind::kInvalidOption, field,
                           fmt::format("{} has the weight {}, not between 0 and 1.", field, x))
                      .Detail("value", x));
    }
    sum += x;
  }
  if (std::abs(sum - 1) <= kBarycentricTolerance) return {};
  return Fail(
      named
          .Bad(FaultKind::kInvalidOption, field,
               fmt::format("{} sums to {}, not to 1 within {}.", field, sum, kBarycentricTolerance))
          .Detail("value", sum));
}

Status CheckAnchor(const PointAnchor& anchor, const Named& named) {
  CHECK_OK(named.CheckRange("position.x", anchor.position.real(), -kInfinity, kInfinity));
  return named.CheckRange("position.y", anchor.position.imag(), -kInfinity, kInfinity);
}

// What needs no mesh.
Status CheckHandle(const Named& named) {
  const Handle& h = named.handle;
  CHECK_OK(std::visit([&](const auto& anchor) { return CheckAnchor(anchor, named); }, h.anchor));
  CHECK_OK(named.CheckRange("weight", h.weight, Handle::kMinWeight, Handle::kMaxWeight));
  CHECK_OK(named.CheckRange("area_radius", h.area_radius, 0, kInfinity));
  CHECK_OK(named.CheckRange("depth", h.depth, -Handle::kMaxDepth, Handle::kMaxDepth));
  return named.CheckRange("depth_falloff", h.depth_falloff, 0, kInfinity);
}

// Where a handle sits; on a vertex one weight is 1.
struct Seat {
  std::uint32_t triangle = kNone;
  std::array<double, 3> barycentric{};
  double snapped = 0;  // normalised
};

Fault OutOfRange(const char* what, std::uint32_t id, std::size_t count, const Named& named) {
  return named
      .Bad(FaultKind::kIndexOutOfRange, named.Field(),
           fmt::format("Handle \"{}\" is on {} {}, but the mesh has {}.", named.handle.id, what, id,
                       count))
      .Detail(what, id)
      .Detail("count", count);
}

class Placer {
 public:
  explicit Placer(const RegisteredMeshParts& mesh)
      : mesh_(mesh), finder_(mesh.nearby, mesh.rest, mesh.mesh.triangles) {}

  // Where a handle is, and the vertices that it holds if it is oriented or has an area.
  struct Found {
    Seat seat;
    Complex rest;
    std::vector<std::uint32_t> held;
  };
  Result<Found> Find(const Named& named) {
    CHECK_OK(CheckHandle(named));
    const Handle& handle = named.handle;
    Found found;
    TRY(found.seat,
        std::visit([&](const auto& anchor) { return SitOn(anchor, named); }, handle.anchor));
    const Triangle& corners = mesh_.mesh.triangles[found.seat.triangle];
    for (std::size_t k = 0; k < 3; ++k) {
      found.rest += found.seat.barycentric[k] * mesh_.rest[corners[k]];
    }
    if (handle.oriented || handle.area_radius > 0) {
      const double radius = handle.area_radius / mesh_.report.diagonal;
      found.held = HeldVertices(found.seat.triangle, found.rest, radius);
    }
    return found;
  }

  Placement PlacementOf(const Handle& handle, const Found& found) const {
    const Triangle& corners = mesh_.mesh.triangles[found.seat.triangle];
    Placement placement;
    for (const std::uint32_t v : found.held) {
      placement.rows.push_back({0, {v, v, v}, {1, 0, 0}, mesh_.rest[v], {}, 0, 0});
    }
    if (found.held.empty()) {
      placement.rows.push_back({0, corners, found.seat.barycentric, found.rest, {}, 0, 0});
    }
    const std::uint32_t component = mesh_.topology.vertex_component[corners[0]];
    for (Row& row : placement.rows) {
      row.offset = row.rest - found.rest;
      row.compliance = handle.hard ? 0 : 1 / handle.weight;
      row.component = component;
    }
    // A vertex answers with its own coordinates to the last bit.
    const auto* on_vertex = std::get_if<VertexAnchor>(&handle.anchor);
    const Complex shown = on_vertex ? mesh_.mesh.vertices[mesh_.repair.VertexOf(on_vertex->vertex)]
                                    : mesh_.origin + mesh_.report.diagonal * found.rest;
    placement.placed = {handle, shown, found.seat.snapped * mesh_.report.diagonal, component};
    return placement;
  }

 private:
  // The seat on the first triangle of the vertex.
  Result<Seat> SitOn(const VertexAnchor& anchor, const Named& named) {
    const auto& triangles = mesh_.mesh.triangles;
    if (anchor.vertex >= mesh_.rest.size()) {
      return Fail(OutOfRange("vertex", anchor.vertex, mesh_.rest.size(), named));
    }
    const std::uint32_t vertex = mesh_.repair.VertexOf(anchor.vertex);
    Seat seat;
    seat.triangle = finder_.Of(vertex);
    if (seat.triangle == kNone) {
      return Fail(
          named
              .Bad(FaultKind::kHandleOutside, named.Field("vertex"),
                   fmt::format("Handle \"{}\" is on vertex {}, which belongs to no triangle.",
                               named.handle.id, vertex))
              .Detail("vertex", vertex));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangles[seat.triangle][k] == vertex) seat.barycentric[k] = 1;
    }
    return seat;
  }

  Result<Seat> SitOn(const TriangleAnchor& anchor, const Named& named) {
    const std::size_t count = mesh_.given_triangles();
    if (anchor.triangle >= count) {
      return Fail(OutOfRange("triangle", anchor.triangle, count, named));
    }
    std::array<double, 3> b = anchor.barycentric;
    const double sum = b[0] + b[1] + b[2];
    // Exactly 1, or a rigid motion far from the origin would not be exact.
    for (double& x : b) x = x / sum;
    if (mesh_.repair.changed()) {
      const Located place = FromGiven(mesh_, anchor.triangle, b);
      if (place.triangle != kNone) return Seat{place.triangle, place.barycentric, 0};
      return Fail(named
                      .Bad(FaultKind::kHandleOutside, named.Field("triangle_point"),
                           fmt::format("Handle \"{}\" is in triangle {}, which is smaller than the "
                                       "tolerance of welding and of which nothing is left.",
                                       named.handle.id, anchor.triangle))
                      .Detail("triangle", anchor.triangle));
    }
    if (mesh_.turned[anchor.triangle]) std::swap(b[1], b[2]);
    return Seat{anchor.triangle, b, 0};
  }

  Result<Seat> SitOn(const PointAnchor& anchor, const Named& named) {
    const std::string field = named.Field("position");
    const Complex p = mesh_.Normalise(anchor.position);
    if (!IsFinite(p)) {
      return Fail(named.Bad(FaultKind::kInvalidOption, field,
                            fmt::format("{} is too far away for this mesh.", field)));
    }
    if (const auto found = finder_.At(p)) return Seat{found->triangle, found->barycentric, 0};
    const Located near = NearestOnBoundary(mesh_.rest, mesh_.mesh.triangles, mesh_.topology, p);
    if (near.distance <= kBorderTolerance) return Seat{near.triangle, near.barycentric, 0};
    if (named.handle.outside == Outside::kSnap) {
      return Seat{near.triangle, near.barycentric, near.distance};
    }
    const double distance = near.distance * mesh_.report.diagonal;
    return Fail(named
                    .Bad(FaultKind::kHandleOutside, field,
                         fmt::format("Handle \"{}\" at ({}, {}) lies outside the mesh by {}; with "
                                     "snap it goes to the nearest point of the border.",
                                     named.handle.id, anchor.position.real(),
                                     anchor.position.imag(), distance))
                    .Detail("distance", distance));
  }

  // The vertices that an oriented or area handle holds: those of its triangle, and those of its
  // component within the radius.
  std::vector<std::uint32_t> HeldVertices(std::uint32_t triangle, Complex rest, double radius) {
    const Triangle& t = mesh_.mesh.triangles[triangle];
    std::vector<std::uint32_t> held(t.begin(), t.end());
    const std::uint32_t component = mesh_.topology.vertex_component[t[0]];
    if (radius > 0) {
      const auto wanted = [&](const TriangleBox& box) {
        return box.x0 <= rest.real() + radius && box.x1 >= rest.real() - radius &&
               box.y0 <= rest.imag() + radius && box.y1 >= rest.imag() - radius;
      };
      finder_.boxes().ForEach(wanted, [&](std::uint32_t near) {
        for (const std::uint32_t v : mesh_.mesh.triangles[near]) {
          if (mesh_.topology.vertex_component[v] == component &&
              std::abs(mesh_.rest[v] - rest) <= radius) {
            held.push_back(v);
          }
        }
      });
    }
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
    return held;
  }

  const RegisteredMeshParts& mesh_;
  TriangleFinder finder_;
};

// Calls visit(handle, found) for every handle in turn, while there is room for their rows beside
// `kept` others.
template <class Visit>
Status ForEachFound(Placer& placer, const RegisteredMeshParts& mesh,
                    std::span<const Handle> handles, std::string_view array, std::size_t kept,
                    const CancelToken& cancel, Visit visit) {
  const std::size_t limit = MostRows(mesh.rest.size());
  std::size_t rows = kept;
  for (std::size_t i = 0; i < handles.size(); ++i) {
    CHECK_OK(cancel.Check());
    const Named named{handles[i], array, i};
    TRY(const auto found, placer.Find(named));
    rows += std::max<std::size_t>(found.held.size(), 1);
    if (rows > limit) {
      return Fail(
          named
              .Bad(
                  FaultKind::kTooManyHandles, named.Field("area_radius"),
                  fmt::format("With handle \"{}\" the set has {} constraint rows, more than the {} "
                              "that this mesh may have: areas overlap too much.",
                              handles[i].id, rows, limit))
              .Detail("count", rows)
              .Detail("limit", limit));
    }
    visit(handles[i], found);
  }
  return {};
}

}  // namespace

Result<std::vector<Placement>> PlaceHandles(const RegisteredMeshParts& mesh,
                                            std::span<const Handle> handles, std::string_view array,
                                            std::size_t kept, const CancelToken& cancel) {
  Placer placer(mesh);
  std::vector<Placement> placements;
  placements.reserve(handles.size());
  CHECK_OK(ForEachFound(placer, mesh, handles, array, kept, cancel,
                        [&](const Handle& handle, const Placer::Found& found) {
                          placements.push_back(placer.PlacementOf(handle, found));
                        }));
  return placements;
}

void CountRow(const Row& row, RowCount& count) {
  ++count.rows;
  if (row.compliance == 0) ++(row.single_vertex() == kNone ? count.inside : count.held);
}

Result<RowCount> CountRows(const RegisteredMesh& mesh, std::span<const Handle> handles,
                           const CancelToken& cancel) {
  Placer placer(mesh.parts());
  RowCount count;
  CHECK_OK(ForEachFound(placer, mesh.parts(), handles, "handles", 0, cancel,
                        [&](const Handle& handle, const Placer::Found& found) {
                          if (handle.depth != 0) ++count.depths;
                          if (found.held.empty()) {
                            CountRow(placer.PlacementOf(handle, found).rows[0], count);
                          } else {
                            count.rows += found.held.size();
                            if (handle.hard) count.held += found.held.size();
                          }
                        }));
  return count;
}

}  // namespace arap
