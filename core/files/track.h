// A track: handles on a mesh and where they go, frame by frame. track_file.h says what stands in
// its text and reads it.
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

// The edit that is done before a frame, or null.
const TrackEdit* EditBefore(const Track& track, std::size_t frame);

// Frames that have the same handles.
struct TrackSegment {
  std::size_t first = 0, end = 0;    // its frames
  const TrackEdit* edit = nullptr;   // done before `first`; the track's; null: none
  std::vector<std::string> ids;      // of the handles, in the order of the targets
  std::vector<std::size_t> numbers;  // of the handles, counted through `handles` and every `add`
};

// Goes through a track, which its edits cut into segments; without edits it is one. There is one at a
// time, since many edits of many handles are far more than the track. Refers to the track. A step
// costs O(handles).
class TrackSegments {
 public:
  // At the first one.
  explicit TrackSegments(const Track& track);

  const TrackSegment& segment() const { return segment_; }
  // Goes on to the next one; false at the end.
  bool Next();
  // The one that has the frame, which is not before this one.
  const TrackSegment& At(std::size_t frame);

 private:
  void Append(const std::vector<TrackHandle>& entries);
  void Edit();  // does the next one

  const Track& track_;
  TrackSegment segment_;
  std::size_t edits_ = 0;   // that are done
  std::size_t number_ = 0;  // of the next handle
};

// ParseTrack reads it back exactly. Every frame has all targets, also those that were kept.
std::string FormatTrack(const Track& track);

}  // namespace arap
