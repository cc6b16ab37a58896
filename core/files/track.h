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
//                "targets": [[x, y], …],            one per handle, in order, units of the mesh
//                "angles": [a, …],                  optional; radians, of oriented handles; else 0
//                "scales": [s, …]}],                optional; of oriented handles; else 1
//    "edits": [{"frame": 60,                        optional; done before this frame; growing
//               "remove": ["head"],                 optional; names
//               "add": [{"name": …}]}],             optional; as "handles"
//    "rigidity": [r, …]}                            optional; one per triangle
//
// The handles of a frame are those of the frame before, less those that an edit removes, and then
// those that it adds. A handle without a name is h0, h1…, counted through "handles" and every
// "add". Other members are ignored.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/handle.h"

namespace arap {

struct TrackHandle {
  Handle handle;            // its weight counts when `own_weight` says so
  Complex rest;             // units of the mesh
  bool own_weight = false;  // else the track's `row_weight` makes it, else it is the default
};

struct TrackFrame {
  std::string kind;
  std::vector<Target> targets;  // one per handle
};

// A change of the handles. Removals come first.
struct TrackEdit {
  std::size_t frame = 0;  // before this one
  std::vector<std::string> remove;
  std::vector<TrackHandle> add;
};

struct Track {
  std::string mesh;
  std::optional<double> row_weight;  // "w"; its square weighs the squared miss in the energy
  std::vector<TrackHandle> handles;
  std::vector<TrackFrame> frames;
  std::vector<TrackEdit> edits;  // by growing frame
  std::vector<double> rigidity;  // per triangle, or empty
};

// Faults are kInvalidOption, "track: " and what is wrong where.
Result<Track> ParseTrack(std::string_view json);
// The same of a file; its faults name it. kNotFound when it cannot be read.
Result<Track> ReadTrack(const std::string& path);
// The text of a track that ParseTrack reads back exactly.
std::string FormatTrack(const Track& track);

// The handles as the core takes them, with the weight that counts. With `hard` all of them meet
// their targets exactly; the weight of a hard handle is the default.
std::vector<Handle> ToHandles(const Track& track, bool hard);
// Those that an edit of the track adds.
std::vector<Handle> ToHandles(const Track& track, std::span<const TrackHandle> entries, bool hard);

// Frames that have the same handles.
struct TrackSegment {
  std::size_t first = 0, end = 0;    // its frames
  const TrackEdit* edit = nullptr;   // done before `first`; the track's; null: none
  std::vector<std::string> ids;      // of the handles, in the order of the targets
  std::vector<std::size_t> numbers;  // of the handles, counted through `handles` and every `add`
};

// The track cut at its edits, at least one segment. Without edits it is all frames.
std::vector<TrackSegment> SegmentsOf(const Track& track);
// The one of them that has the frame.
const TrackSegment& SegmentAt(std::span<const TrackSegment> segments, std::size_t frame);

}  // namespace arap
