#include "core/files/track_writer.h"

#include <cstddef>
#include <type_traits>
#include <variant>

#include <nlohmann/json.hpp>

namespace arap {
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
