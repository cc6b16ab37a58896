#include "core/files/track.h"

#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/files/text_file.h"

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;

auto Bad(const std::string& message) {
  return Fail(FaultKind::kInvalidOption, "track: " + message);
}

// The member when it is there, else null. Never throws, whatever `object` is.
const Json& Member(const Json& object, const char* name) {
  static const Json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(name);
  return found == object.end() ? kNull : *found;
}

bool ReadNumbers(const Json& array, std::size_t count, double* out) {
  if (!array.is_array() || array.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (!array[i].is_number()) return false;
    out[i] = array[i].get<double>();
  }
  return true;
}

bool ReadIndex(const Json& number, std::uint32_t& out) {
  if (!number.is_number_unsigned() || number.get<std::uint64_t>() > UINT32_MAX) return false;
  out = number.get<std::uint32_t>();
  return true;
}

// Optional members: false when one is there and is something else.
bool ReadOptional(const Json& value, double& out) {
  if (value.is_number()) out = value.get<double>();
  return value.is_null() || value.is_number();
}
bool ReadOptional(const Json& value, bool& out) {
  if (value.is_boolean()) out = value.get<bool>();
  return value.is_null() || value.is_boolean();
}
bool ReadOptional(const Json& array, std::size_t count, std::vector<double>& out) {
  if (array.is_null()) return true;
  out.resize(count);
  return ReadNumbers(array, count, out.data());
}

bool ReadGrip(const Json& json, TrackHandle& handle) {
  if (const Json& weight = Member(json, "weight"); weight.is_number()) {
    handle.weight = weight.get<double>();
  } else if (!weight.is_null()) {
    return false;
  }
  return ReadOptional(Member(json, "hard"), handle.hard) &&
         ReadOptional(Member(json, "oriented"), handle.oriented) &&
         ReadOptional(Member(json, "snap"), handle.snap) &&
         ReadOptional(Member(json, "area_radius"), handle.area_radius) &&
         ReadOptional(Member(json, "depth"), handle.depth) &&
         ReadOptional(Member(json, "depth_falloff"), handle.depth_falloff);
}

// `number` names a handle without a name.
Result<TrackHandle> ReadHandle(const Json& json, const std::string& where, std::size_t number) {
  TrackHandle handle;
  const Json& name = Member(json, "name");
  handle.name = name.is_string() ? name.get<std::string>() : fmt::format("h{}", number);
  std::array<double, 2> rest{};
  if (!ReadNumbers(Member(json, "rest"), 2, rest.data())) {
    return Bad(where + " needs \"rest\": [x, y]");
  }
  handle.rest_x = rest[0];
  handle.rest_y = rest[1];
  if (!Member(json, "triangle").is_null()) {
    client::TriangleAnchor anchor;
    if (!ReadIndex(Member(json, "triangle"), anchor.triangle) ||
        !ReadNumbers(Member(json, "bary"), 3, anchor.barycentric.data())) {
      return Bad(where + " needs \"triangle\": index with \"bary\": [a, b, c]");
    }
    handle.anchor = anchor;
  } else if (!Member(json, "vertex").is_null()) {
    client::VertexAnchor anchor;
    if (!ReadIndex(Member(json, "vertex"), anchor.vertex)) {
      return Bad(where + ": \"vertex\" is not an index");
    }
    handle.anchor = anchor;
  } else {
    handle.anchor = client::PointAnchor{rest[0], rest[1]};
  }
  if (!ReadGrip(json, handle)) {
    return Bad(where +
               ": weight, area_radius, depth and depth_falloff are numbers; hard, oriented "
               "and snap are true or false");
  }
  return handle;
}

// `number` is that of the first handle that it adds.
Result<TrackEdit> ReadEdit(const Json& json, std::size_t index, std::size_t number) {
  const Json& remove = Member(json, "remove");
  const Json& add = Member(json, "add");
  std::uint32_t frame = 0;
  if (!ReadIndex(Member(json, "frame"), frame) || (remove.empty() && add.empty())) {
    return Bad(fmt::format("edit {} needs \"frame\": index and \"remove\" or \"add\"", index));
  }
  TrackEdit edit{frame, {}, {}};
  if (!(remove.is_null() || remove.is_array()) || !(add.is_null() || add.is_array())) {
    return Bad(fmt::format("edit {}: \"remove\" and \"add\" are arrays", index));
  }
  for (const Json& id : remove) {
    if (!id.is_string()) return Bad(fmt::format("edit {}: \"remove\" has names", index));
    edit.remove.push_back(id.get<std::string>());
  }
  for (const Json& entry : add) {
    const std::size_t k = edit.add.size();
    Result<TrackHandle> handle =
        ReadHandle(entry, fmt::format("edit {}: handle {}", index, k), number + k);
    if (!handle) return Fail(handle.error());
    edit.add.push_back(*std::move(handle));
  }
  return edit;
}

Status ReadEdits(const Json& edits, Track& track) {
  if (!edits.is_null() && !edits.is_array()) return Bad("\"edits\" is not an array");
  std::size_t number = track.handles.size();
  for (const Json& entry : edits) {
    Result<TrackEdit> edit = ReadEdit(entry, track.edits.size(), number);
    if (!edit) return Fail(edit.error());
    number += edit->add.size();
    track.edits.push_back(*std::move(edit));
  }
  return {};
}

// Frames grow and are those of the track; what is removed is there.
Status CheckEdits(const Track& track) {
  std::set<std::string> names;
  for (const TrackHandle& handle : track.handles) names.insert(handle.name);
  for (std::size_t i = 0; i < track.edits.size(); ++i) {
    const TrackEdit& edit = track.edits[i];
    if (edit.frame >= track.frames.size() || (i > 0 && edit.frame <= track.edits[i - 1].frame)) {
      return Bad(fmt::format("edit {}: the frames of edits are frames of the track and grow", i));
    }
    for (const std::string& name : edit.remove) {
      if (names.erase(name) == 0) {
        return Bad(fmt::format("edit {} removes \"{}\", which is not there", i, name));
      }
    }
    for (const TrackHandle& handle : edit.add) names.insert(handle.name);
  }
  return {};
}

Result<TrackFrame> ReadFrame(const Json& json, std::size_t index, std::size_t handle_count) {
  TrackFrame frame;
  const Json& kind = Member(json, "kind");
  if (kind.is_string()) frame.kind = kind.get<std::string>();
  const Json& targets = Member(json, "targets");
  if (!targets.is_array() || targets.size() != handle_count) {
    return Bad(fmt::format("frame {} needs \"targets\" with one pair per handle", index));
  }
  frame.targets.resize(2 * handle_count);
  for (std::size_t k = 0; k < handle_count; ++k) {
    if (!ReadNumbers(targets[k], 2, &frame.targets[2 * k])) {
      return Bad(fmt::format("frame {}: target {} is not [x, y]", index, k));
    }
  }
  if (!ReadOptional(Member(json, "angles"), handle_count, frame.angles) ||
      !ReadOptional(Member(json, "scales"), handle_count, frame.scales)) {
    return Bad(fmt::format("frame {}: angles and scales have one number per handle", index));
  }
  return frame;
}

}  // namespace

Result<Track> ParseTrack(std::string_view text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return Bad("not a JSON object");
  const Json& handles = Member(json, "handles");
  const Json& frames = Member(json, "frames");
  if (!handles.is_array() || !frames.is_array()) {
    return Bad("needs the arrays \"handles\" and \"frames\"");
  }
  Track track;
  if (Member(json, "mesh").is_string()) track.mesh = Member(json, "mesh").get<std::string>();
  if (const Json& weight = Member(json, "w"); weight.is_number()) {
    track.row_weight = weight.get<double>();
  }
  const Json& rigidity = Member(json, "rigidity");
  if (!ReadOptional(rigidity, rigidity.size(), track.rigidity)) {
    return Bad("\"rigidity\" is not an array of numbers");
  }
  for (const Json& entry : handles) {
    Result<TrackHandle> handle =
        ReadHandle(entry, fmt::format("handle {}", track.handles.size()), track.handles.size());
    if (!handle) return Fail(handle.error());
    track.handles.push_back(*std::move(handle));
  }
  if (Status read = ReadEdits(Member(json, "edits"), track); !read) return Fail(read.error());
  track.frames.resize(frames.size());
  if (Status good = CheckEdits(track); !good) return Fail(good.error());
  for (const TrackSegment& segment : SegmentsOf(track)) {
    for (std::size_t i = segment.first; i < segment.end; ++i) {
      Result<TrackFrame> frame = ReadFrame(frames[i], i, segment.ids.size());
      if (!frame) return Fail(frame.error());
      track.frames[i] = *std::move(frame);
    }
  }
  return track;
}

Result<Track> ReadTrack(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error());
  Result<Track> track = ParseTrack(*text);
  if (!track) track.error().message = path + ": " + track.error().message;
  return track;
}

}  // namespace arap::cli
