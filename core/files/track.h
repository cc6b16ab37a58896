// A track: handles on a mesh and where they go, frame by frame. track_file.h has its text.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arap/model/handle.h"
#include "arap/model/mesh.h"

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
  std::vector<TrackEdit> edits;   // by growing frame
  std::vector<double> rigidity;   // per triangle, or empty
  std::vector<Warning> warnings;  // of reading it: what was not there
};

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
