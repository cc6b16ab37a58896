// Handles: places of a mesh that the caller moves, and where they should go.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "arap/client/mesh.h"

namespace arap::client {

// Where a handle holds the rest mesh.
struct VertexAnchor {
  std::uint32_t vertex = 0;  // below #V
};
struct TriangleAnchor {
  std::uint32_t triangle = 0;           // below #F
  std::array<double, 3> barycentric{};  // in the order of the triangle's corners, sum 1 ± 1e-6
};
struct PointAnchor {
  double x = 0, y = 0;  // rest position in units of the mesh; the server finds the triangle
};

struct Handle {
  std::string id;  // unique in the set, 1 to 128 characters of [A-Za-z0-9._-]
  std::variant<VertexAnchor, TriangleAnchor, PointAnchor> anchor;
  // Of the squared miss, 1e-6 to 1e12. The server's default is 1e6.
  std::optional<double> weight = std::nullopt;
  bool hard = false;         // meet the target exactly; weight is ignored
  bool oriented = false;     // hold orientation and scale too: the whole triangle follows
  double area_radius = 0;    // hold every vertex within this rest distance; units of the mesh
  bool snap = false;         // a PointAnchor outside moves to the boundary instead of failing
  double depth = 0;          // for the drawing order: higher is nearer
  double depth_falloff = 0;  // rest distance over which the depth fades; 0: it holds everywhere
};

// Where a handle should go, in units of the mesh. Angle and scale are for oriented handles, against
// the rest pose.
struct HandleTarget {
  std::string id;
  double x = 0, y = 0;
  double angle_radians = 0;
  double scale = 1;
};

// A handle as the server placed it.
struct HandleInfo {
  std::string id;
  double rest_x = 0, rest_y = 0;  // after any snapping
  double snapped_distance = 0;    // units of the mesh; 0 if it was not snapped
  std::uint32_t component = 0;    // its connected component
};

// A compiled handle set.
struct HandleSetInfo {
  std::string id;
  std::string mesh_id;
  std::vector<HandleInfo> handles;  // in the order of `positions` of an update
  std::uint64_t row_count = 0;      // constraint rows: the size of the dense system
  std::uint64_t bytes = 0;          // held beside the mesh
  std::vector<Warning> warnings;
  std::vector<double> depth;                 // per vertex, length 0 or #V
  std::vector<std::uint32_t> draw_order;     // triangles back to front, length 0 or #F
  std::uint64_t revision = 0;                // grows by one with every edit
  std::uint64_t resting_components = 0;      // components without a handle, which stay at rest
  std::uint64_t translating_components = 0;  // components with one distinct handle
};

// The answer to a compilation or an edit.
struct CompiledHandles {
  HandleSetInfo handle_set;
  double queue_micros = 0;
  double solve_micros = 0;
};

}  // namespace arap::client
