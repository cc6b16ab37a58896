// TRACK.json: handles on a mesh and where they go, frame by frame.
//
//   {"mesh": "bear.obj",                            the OBJ file beside it; for people
//    "w": 1000,                                     optional; weight of the handle rows
//    "handles": [{"name": "head",                   optional name; 1 to 128 of [A-Za-z0-9._-]
//                 "rest": [x, y],                   units of the mesh
//                 "triangle": 7, "bary": [a, b, c], optional; holds here, else
//                 "vertex": 12,                     optional; holds here, else at `rest`
//                 "weight": 1e6,                    of the squared miss; before "w"
//                 "hard": true,                     meet the target exactly
//                 "oriented": true,                 hold orientation and scale too
//                 "area_radius": 5,                 hold every vertex around rigidly
//                 "snap": true,                     a `rest` outside moves to the boundary
//                 "depth": 1, "depth_falloff": 9}], for the drawing order; optional, as all six
//    "frames": [{"kind": "wave",                    optional; for people
//                "targets": [[x, y], …]}]}          one per handle, in order, units of the mesh
//
// Other members are ignored.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "arap/client/handles.h"
#include "core/base/result.h"

namespace arap::cli {

struct TrackHandle {
  std::string name;
  double rest_x = 0, rest_y = 0;
  std::variant<client::VertexAnchor, client::TriangleAnchor, client::PointAnchor> anchor;
  std::optional<double> weight = std::nullopt;  // of the squared miss
  bool hard = false, oriented = false, snap = false;
  double area_radius = 0, depth = 0, depth_falloff = 0;
};

struct TrackFrame {
  std::string kind;
  std::vector<double> targets;  // x y x y…, length 2·#handles
  std::vector<double> angles;   // radians, length 0 or #handles
  std::vector<double> scales;   // length 0 or #handles
};

struct Track {
  std::string mesh;
  std::optional<double> row_weight;  // "w"; its square weighs the squared miss in the energy
  std::vector<TrackHandle> handles;
  std::vector<TrackFrame> frames;
  std::vector<double> rigidity;  // per triangle, or empty
};

Result<Track> ParseTrack(std::string_view json);
Result<Track> ReadTrack(const std::string& path);
// The text of a track that ParseTrack reads back exactly.
std::string FormatTrack(const Track& track);

// The handles for the server; `hard` ones meet their targets exactly.
std::vector<client::Handle> ToHandles(const Track& track, bool hard);
std::vector<std::string> HandleIds(const Track& track);

}  // namespace arap::cli
