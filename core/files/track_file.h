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
//                "targets": [[x, y], null, …],      one per handle, in order, units of the mesh
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
//
// A marker that was lost is null, or is missing at the end of its list: the handle keeps what it had
// in the frame before, in its first frame its rest place. A handle that keeps its place keeps its
// angle and scale too, unless these are given. How many were kept is a warning of the track. Targets
// that are missing, not null, may be 65536 and one more for every eight bytes of the text. There are
// at most 100000 handles. So what a track takes is bounded by its text.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/files/track.h"

namespace arap {

// Faults are kInvalidOption, "NAME:3:14: " and what is wrong, with line and column.
Result<Track> ParseTrack(std::string_view json, const std::string& name);
// The same of a file under its path. kNotFound when it cannot be read.
Result<Track> ReadTrack(const std::string& path);

}  // namespace arap
