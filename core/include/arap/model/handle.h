// Handles: places of a mesh that the user moves, and where they should go.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

#include "arap/model/mesh.h"

namespace arap {

struct VertexAnchor {
  std::uint32_t vertex = 0;  // below #V

  bool operator==(const VertexAnchor&) const = default;
};
struct TriangleAnchor {
  std::uint32_t triangle = 0;  // below #F
  // In the order of the triangle as it was sent. Each 0 to 1, their sum 1, within 1e-6.
  std::array<double, 3> barycentric{};

  bool operator==(const TriangleAnchor&) const = default;
};
struct PointAnchor {
  Complex position;  // units of the mesh; its triangle is found, the lowest where they overlap

  bool operator==(const PointAnchor&) const = default;
};

// What to do with a PointAnchor outside the mesh.
enum class Outside {
  kError,
  kSnap,  // move it to the nearest point of the boundary
};

struct Handle {
  // Weight of the paper's rows (w = 1000) on the squared residual [algorithm §1].
  static constexpr double kDefaultWeight = 1e6;
  static constexpr double kMinWeight = 1e-6;
  static constexpr double kMaxWeight = 1e12;
  // So that the depths of all handles together are finite, as floats too.
  static constexpr double kMaxDepth = 1e30;

  std::string id;  // unique in the set, 1 to 128 characters of [A-Za-z0-9._-]
  std::variant<VertexAnchor, TriangleAnchor, PointAnchor> anchor;
  // On the squared residual, kMinWeight to kMaxWeight. Plays no part when hard.
  double weight = kDefaultWeight;
  bool hard = false;       // meet the target exactly
  bool oriented = false;   // hold orientation and scale too: the whole triangle is placed
  double area_radius = 0;  // hold every vertex within this rest distance; implies oriented
  Outside outside = Outside::kError;
  double depth = 0;          // for the drawing order, higher is nearer; ±kMaxDepth
  double depth_falloff = 0;  // rest distance over which depth fades to 0; 0: constant

  bool operator==(const Handle&) const = default;
};

// The fields of a handle beside its id and its anchor, by the names that records and track files
// give them; "snap" is true for kSnap.
struct HandleField {
  const char* name;
  std::variant<double Handle::*, bool Handle::*, Outside Handle::*> member;
};
inline constexpr HandleField kHandleFields[] = {
    {"weight", &Handle::weight},
    {"hard", &Handle::hard},
    {"oriented", &Handle::oriented},
    {"snap", &Handle::outside},
    {"area_radius", &Handle::area_radius},
    {"depth", &Handle::depth},
    {"depth_falloff", &Handle::depth_falloff},
};

// Where a handle should go. Angle and scale are against the rest pose; oriented handles only.
struct Target {
  static constexpr double kMaxScale = 1e6;

  Complex position;  // units of the mesh
  double angle = 0;  // radians, counter-clockwise
  double scale = 1;  // 0 to kMaxScale

  bool operator==(const Target&) const = default;
};

// A target with the handle that it is for.
struct HandleTarget {
  std::string handle_id;
  Target target;

  bool operator==(const HandleTarget&) const = default;
};

// A handle as it was found on the mesh.
struct PlacedHandle {
  Handle handle;
  Complex rest;                 // units of the mesh
  double snapped_distance = 0;  // how far Outside::kSnap moved it
  std::uint32_t component = 0;  // its connected component

  bool operator==(const PlacedHandle&) const = default;
};

}  // namespace arap
