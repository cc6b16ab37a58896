#include "client/cli/track.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/text_file.h"

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

// Only what differs from the defaults.
void WriteGrip(const TrackHandle& handle, Json& out) {
  if (handle.weight) out["weight"] = *handle.weight;
  if (handle.hard) out["hard"] = true;
  if (handle.oriented) out["oriented"] = true;
  if (handle.snap) out["snap"] = true;
  if (handle.area_radius != 0) out["area_radius"] = handle.area_radius;
  if (handle.depth != 0) out["depth"] = handle.depth;
  if (handle.depth_falloff != 0) out["depth_falloff"] = handle.depth_falloff;
}

Result<TrackHandle> ReadHandle(const Json& json, std::size_t index) {
  TrackHandle handle;
  const std::string where = fmt::format("handle {}", index);
  const Json& name = Member(json, "name");
  handle.name = name.is_string() ? name.get<std::string>() : fmt::format("h{}", index);
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

struct AnchorToJson {
  Json& out;

  void operator()(const client::VertexAnchor& anchor) const { out["vertex"] = anchor.vertex; }
  void operator()(const client::TriangleAnchor& anchor) const {
    out["triangle"] = anchor.triangle;
    out["bary"] = anchor.barycentric;
  }
  void operator()(const client::PointAnchor&) const {}
};

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
    Result<TrackHandle> handle = ReadHandle(entry, track.handles.size());
    if (!handle) return Fail(handle.error());
    track.handles.push_back(*std::move(handle));
  }
  for (const Json& entry : frames) {
    Result<TrackFrame> frame = ReadFrame(entry, track.frames.size(), track.handles.size());
    if (!frame) return Fail(frame.error());
    track.frames.push_back(*std::move(frame));
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

std::string FormatTrack(const Track& track) {
  Json json;
  if (!track.mesh.empty()) json["mesh"] = track.mesh;
  if (track.row_weight) json["w"] = *track.row_weight;
  json["handles"] = Json::array();
  for (const TrackHandle& handle : track.handles) {
    Json entry;
    entry["name"] = handle.name;
    entry["rest"] = {handle.rest_x, handle.rest_y};
    std::visit(AnchorToJson{entry}, handle.anchor);
    WriteGrip(handle, entry);
    json["handles"].push_back(std::move(entry));
  }
  json["frames"] = Json::array();
  for (const TrackFrame& frame : track.frames) {
    Json entry;
    entry["i"] = json["frames"].size();
    entry["kind"] = frame.kind;
    entry["targets"] = Json::array();
    for (std::size_t k = 0; k < frame.targets.size(); k += 2) {
      entry["targets"].push_back({frame.targets[k], frame.targets[k + 1]});
    }
    if (!frame.angles.empty()) entry["angles"] = frame.angles;
    if (!frame.scales.empty()) entry["scales"] = frame.scales;
    json["frames"].push_back(std::move(entry));
  }
  if (!track.rigidity.empty()) json["rigidity"] = track.rigidity;
  return json.dump() + "\n";
}

std::vector<client::Handle> ToHandles(const Track& track, bool hard) {
  std::vector<client::Handle> handles;
  for (const TrackHandle& entry : track.handles) {
    client::Handle& handle = handles.emplace_back();
    handle.id = entry.name;
    handle.anchor = entry.anchor;
    handle.hard = hard || entry.hard;
    handle.oriented = entry.oriented;
    handle.area_radius = entry.area_radius;
    handle.snap = entry.snap;
    handle.depth = entry.depth;
    handle.depth_falloff = entry.depth_falloff;
    if (handle.hard) continue;
    if (track.row_weight) handle.weight = *track.row_weight * *track.row_weight;
    if (entry.weight) handle.weight = entry.weight;
  }
  return handles;
}

std::vector<std::string> HandleIds(const Track& track) {
  std::vector<std::string> ids;
  for (const TrackHandle& handle : track.handles) ids.push_back(handle.name);
  return ids;
}

}  // namespace arap::cli
