// The text of a track.
#include <utility>

#include <nlohmann/json.hpp>

#include "core/files/track.h"

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;

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

struct AnchorToJson {
  Json& out;

  void operator()(const client::VertexAnchor& anchor) const { out["vertex"] = anchor.vertex; }
  void operator()(const client::TriangleAnchor& anchor) const {
    out["triangle"] = anchor.triangle;
    out["bary"] = anchor.barycentric;
  }
  void operator()(const client::PointAnchor&) const {}
};

Json ToJson(const TrackHandle& handle) {
  Json json;
  json["name"] = handle.name;
  json["rest"] = {handle.rest_x, handle.rest_y};
  std::visit(AnchorToJson{json}, handle.anchor);
  WriteGrip(handle, json);
  return json;
}

}  // namespace

std::string FormatTrack(const Track& track) {
  Json json;
  if (!track.mesh.empty()) json["mesh"] = track.mesh;
  if (track.row_weight) json["w"] = *track.row_weight;
  json["handles"] = Json::array();
  for (const TrackHandle& handle : track.handles) json["handles"].push_back(ToJson(handle));
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
  for (const TrackEdit& edit : track.edits) {
    Json entry;
    entry["frame"] = edit.frame;
    if (!edit.remove.empty()) entry["remove"] = edit.remove;
    for (const TrackHandle& handle : edit.add) entry["add"].push_back(ToJson(handle));
    json["edits"].push_back(std::move(entry));
  }
  if (!track.rigidity.empty()) json["rigidity"] = track.rigidity;
  return json.dump() + "\n";
}

}  // namespace arap::cli
