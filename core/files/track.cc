#include "core/files/track.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/try.h"
#include "core/files/text_file.h"

namespace arap {
namespace {

using Json = nlohmann::ordered_json;

auto Bad(const std::string& message) {
  return Fail(FaultKind::kInvalidOption, "track: " + message);
}

// The member when it is there, else null. Never throws, whatever `object` is.
const Json& Member(const Json& object, const char* name) {
  static const Json* const kNull = new Json;
  if (!object.is_object()) return *kNull;
  const auto found = object.find(name);
  return found == object.end() ? *kNull : *found;
}

bool ReadNumbers(const Json& array, std::size_t count, double* out) {
  if (!array.is_array() || array.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (!array[i].is_number()) return false;
    out[i] = array[i].get<double>();
  }
  return true;
}

bool ReadPoint(const Json& array, Complex& out) {
  std::array<double, 2> xy{};
  if (!ReadNumbers(array, 2, xy.data())) return false;
  out = {xy[0], xy[1]};
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

bool ReadOptional(const Json& value, Outside& out) {
  bool snap = false;
  const bool good = ReadOptional(value, snap);
  if (snap) out = Outside::kSnap;
  return good;
}

// The fields beside name and anchor; each may be missing.
bool ReadFields(const Json& json, TrackHandle& out) {
  out.own_weight = Member(json, "weight").is_number();
  return std::ranges::all_of(kHandleFields, [&](const HandleField& field) {
    const Json& value = Member(json, field.name);
    return std::visit([&](auto member) { return ReadOptional(value, out.handle.*member); },
                      field.member);
  });
}

// `number` names a handle without a name.
Result<TrackHandle> ReadHandle(const Json& json, const std::string& where, std::size_t number) {
  TrackHandle out;
  const Json& name = Member(json, "name");
  out.handle.id = name.is_string() ? name.get<std::string>() : fmt::format("h{}", number);
  if (!ReadPoint(Member(json, "rest"), out.rest)) return Bad(where + " needs \"rest\": [x, y]");
  if (!Member(json, "triangle").is_null()) {
    TriangleAnchor anchor;
    if (!ReadIndex(Member(json, "triangle"), anchor.triangle) ||
        !ReadNumbers(Member(json, "bary"), 3, anchor.barycentric.data())) {
      return Bad(where + " needs \"triangle\": index with \"bary\": [a, b, c]");
    }
    out.handle.anchor = anchor;
  } else if (!Member(json, "vertex").is_null()) {
    VertexAnchor anchor;
    if (!ReadIndex(Member(json, "vertex"), anchor.vertex)) {
      return Bad(where + ": \"vertex\" is not an index");
    }
    out.handle.anchor = anchor;
  } else {
    out.handle.anchor = PointAnchor{out.rest};
  }
  if (!ReadFields(json, out)) {
    return Bad(where +
               ": weight, area_radius, depth and depth_falloff are numbers; hard, oriented "
               "and snap are true or false");
  }
  return out;
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
    TRY(TrackHandle handle,
        ReadHandle(entry, fmt::format("edit {}: handle {}", index, k), number + k));
    edit.add.push_back(std::move(handle));
  }
  return edit;
}

Status ReadEdits(const Json& edits, Track& track) {
  if (!edits.is_null() && !edits.is_array()) return Bad("\"edits\" is not an array");
  std::size_t number = track.handles.size();
  for (const Json& entry : edits) {
    TRY(TrackEdit edit, ReadEdit(entry, track.edits.size(), number));
    number += edit.add.size();
    track.edits.push_back(std::move(edit));
  }
  return {};
}

// Frames grow and are those of the track; what is removed is there.
Status CheckEdits(const Track& track) {
  std::set<std::string> ids;
  for (const TrackHandle& entry : track.handles) ids.insert(entry.handle.id);
  for (std::size_t i = 0; i < track.edits.size(); ++i) {
    const TrackEdit& edit = track.edits[i];
    if (edit.frame >= track.frames.size() || (i > 0 && edit.frame <= track.edits[i - 1].frame)) {
      return Bad(fmt::format("edit {}: the frames of edits are frames of the track and grow", i));
    }
    for (const std::string& id : edit.remove) {
      if (ids.erase(id) == 0) {
        return Bad(fmt::format("edit {} removes \"{}\", which is not there", i, id));
      }
    }
    for (const TrackHandle& entry : edit.add) ids.insert(entry.handle.id);
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
  std::vector<double> angles(handle_count, 0), scales(handle_count, 1);
  frame.targets.resize(handle_count);
  for (std::size_t k = 0; k < handle_count; ++k) {
    if (!ReadPoint(targets[k], frame.targets[k].position)) {
      return Bad(fmt::format("frame {}: target {} is not [x, y]", index, k));
    }
  }
  if (!ReadOptional(Member(json, "angles"), handle_count, angles) ||
      !ReadOptional(Member(json, "scales"), handle_count, scales)) {
    return Bad(fmt::format("frame {}: angles and scales have one number per handle", index));
  }
  for (std::size_t k = 0; k < handle_count; ++k) {
    frame.targets[k].angle = angles[k];
    frame.targets[k].scale = scales[k];
  }
  return frame;
}

struct AnchorToJson {
  Json& out;

  void operator()(const VertexAnchor& anchor) const { out["vertex"] = anchor.vertex; }
  void operator()(const TriangleAnchor& anchor) const {
    out["triangle"] = anchor.triangle;
    out["bary"] = anchor.barycentric;
  }
  void operator()(const PointAnchor&) const {}
};

// Only what differs from the defaults.
Json ToJson(const TrackHandle& entry) {
  const Handle& handle = entry.handle;
  Json json;
  json["name"] = handle.id;
  json["rest"] = {entry.rest.real(), entry.rest.imag()};
  std::visit(AnchorToJson{json}, handle.anchor);
  if (entry.own_weight) json["weight"] = handle.weight;
  Handle plain;
  plain.weight = handle.weight;
  for (const HandleField& field : kHandleFields) {
    const auto write = [&](auto member) {
      if (handle.*member == plain.*member) return;
      if constexpr (std::is_same_v<decltype(member), Outside Handle::*>) {
        json[field.name] = true;
      } else {
        json[field.name] = handle.*member;
      }
    };
    std::visit(write, field.member);
  }
  return json;
}

Json ToJson(const TrackFrame& frame, std::size_t index) {
  Json json;
  json["i"] = index;
  json["kind"] = frame.kind;
  json["targets"] = Json::array();
  bool turned = false, scaled = false;
  for (const Target& target : frame.targets) {
    json["targets"].push_back({target.position.real(), target.position.imag()});
    turned = turned || target.angle != 0;
    scaled = scaled || target.scale != 1;
  }
  for (const Target& target : frame.targets) {
    if (turned) json["angles"].push_back(target.angle);
    if (scaled) json["scales"].push_back(target.scale);
  }
  return json;
}

Json ToJson(const TrackEdit& edit) {
  Json json;
  json["frame"] = edit.frame;
  if (!edit.remove.empty()) json["remove"] = edit.remove;
  for (const TrackHandle& entry : edit.add) json["add"].push_back(ToJson(entry));
  return json;
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
    const std::size_t k = track.handles.size();
    TRY(TrackHandle handle, ReadHandle(entry, fmt::format("handle {}", k), k));
    track.handles.push_back(std::move(handle));
  }
  CHECK_OK(ReadEdits(Member(json, "edits"), track));
  track.frames.resize(frames.size());
  CHECK_OK(CheckEdits(track));
  for (const TrackSegment& segment : SegmentsOf(track)) {
    for (std::size_t i = segment.first; i < segment.end; ++i) {
      TRY(track.frames[i], ReadFrame(frames[i], i, segment.ids.size()));
    }
  }
  return track;
}

Result<Track> ReadTrack(const std::string& path) {
  TRY(const std::string text, ReadTextFile(path));
  Result<Track> track = ParseTrack(text);
  if (!track) track.error().message = path + ": " + track.error().message;
  return track;
}

std::string FormatTrack(const Track& track) {
  Json json;
  if (!track.mesh.empty()) json["mesh"] = track.mesh;
  if (track.row_weight) json["w"] = *track.row_weight;
  json["handles"] = Json::array();
  for (const TrackHandle& entry : track.handles) json["handles"].push_back(ToJson(entry));
  json["frames"] = Json::array();
  for (const TrackFrame& frame : track.frames) {
    json["frames"].push_back(ToJson(frame, json["frames"].size()));
  }
  for (const TrackEdit& edit : track.edits) json["edits"].push_back(ToJson(edit));
  if (!track.rigidity.empty()) json["rigidity"] = track.rigidity;
  return json.dump() + "\n";
}

std::vector<Handle> ToHandles(const Track& track, std::span<const TrackHandle> entries, bool hard) {
  std::vector<Handle> handles;
  for (const TrackHandle& entry : entries) {
    Handle& handle = handles.emplace_back(entry.handle);
    handle.hard = hard || handle.hard;
    if (handle.hard) {
      handle.weight = Handle::kDefaultWeight;
    } else if (!entry.own_weight && track.row_weight) {
      handle.weight = *track.row_weight * *track.row_weight;
    }
  }
  return handles;
}

std::vector<Handle> ToHandles(const Track& track, bool hard) {
  return ToHandles(track, track.handles, hard);
}

std::vector<TrackSegment> SegmentsOf(const Track& track) {
  std::vector<TrackSegment> segments(1);
  std::size_t number = 0;
  const auto append = [&](const std::vector<TrackHandle>& entries) {
    for (const TrackHandle& entry : entries) {
      segments.back().ids.push_back(entry.handle.id);
      segments.back().numbers.push_back(number++);
    }
  };
  append(track.handles);
  for (const TrackEdit& edit : track.edits) {
    if (edit.frame > 0) {
      TrackSegment next = segments.back();
      segments.back().end = next.first = edit.frame;
      segments.push_back(std::move(next));
    }
    TrackSegment& segment = segments.back();
    segment.edit = &edit;
    for (const std::string& id : edit.remove) {
      const auto found = std::find(segment.ids.begin(), segment.ids.end(), id);
      if (found == segment.ids.end()) continue;
      segment.numbers.erase(segment.numbers.begin() + (found - segment.ids.begin()));
      segment.ids.erase(found);
    }
    append(edit.add);
  }
  segments.back().end = track.frames.size();
  return segments;
}

const TrackSegment& SegmentAt(std::span<const TrackSegment> segments, std::size_t frame) {
  const auto next = std::upper_bound(
      segments.begin() + 1, segments.end(), frame,
      [](std::size_t f, const TrackSegment& segment) { return f < segment.first; });
  return *std::prev(next);
}

}  // namespace arap
