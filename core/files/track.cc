#include "core/files/track.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

namespace arap {

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

const TrackEdit* EditBefore(const Track& track, std::size_t frame) {
  const auto edit =
      std::lower_bound(track.edits.begin(), track.edits.end(), frame,
                       [](const TrackEdit& each, std::size_t f) { return each.frame < f; });
  return edit != track.edits.end() && edit->frame == frame ? &*edit : nullptr;
}

TrackSegments::TrackSegments(const Track& track) : track_(track) {
  Append(track.handles);
  segment_.end = track.frames.size();
  if (track.edits.empty()) return;
  if (track.edits.front().frame == 0) {
    Edit();
  } else {
    segment_.end = track.edits.front().frame;
  }
}

bool TrackSegments::Next() {
  if (edits_ == track_.edits.size()) return false;
  Edit();
  return true;
}

const TrackSegment& TrackSegments::At(std::size_t frame) {
  while (frame >= segment_.end && Next()) {
  }
  return segment_;
}

void TrackSegments::Append(const std::vector<TrackHandle>& entries) {
  for (const TrackHandle& entry : entries) {
    segment_.ids.push_back(entry.handle.id);
    segment_.numbers.push_back(number_++);
  }
}

void TrackSegments::Edit() {
  const TrackEdit& edit = track_.edits[edits_++];
  segment_.edit = &edit;
  segment_.first = edit.frame;
  segment_.end = edits_ < track_.edits.size() ? track_.edits[edits_].frame : track_.frames.size();
  std::unordered_set<std::string_view> removed(edit.remove.begin(), edit.remove.end());
  std::size_t kept = 0;
  for (std::size_t k = 0; k < segment_.ids.size(); ++k) {
    if (!removed.empty() && removed.erase(segment_.ids[k]) > 0) continue;
    if (kept < k) segment_.ids[kept] = std::move(segment_.ids[k]);
    segment_.numbers[kept++] = segment_.numbers[k];
  }
  segment_.ids.resize(kept);
  segment_.numbers.resize(kept);
  Append(edit.add);
}

namespace {

using Json = nlohmann::ordered_json;

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

}  // namespace arap
