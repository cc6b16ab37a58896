#include "core/files/track_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/try.h"
#include "core/files/json_text.h"
#include "core/files/text_file.h"

namespace arap {
namespace {

constexpr std::size_t kMaxTrackHandles = 100'000;  // far beyond what a server takes
constexpr std::size_t kMissingTargets = 65'536;    // and one more for every eight characters

// The member when it is there, else null. Never throws, whatever `object` is.
const JsonValue& Member(const JsonValue& object, const char* name) {
  static const JsonValue* const kNull = new JsonValue;
  if (!object.is_object()) return *kNull;
  const auto found = object.find(name);
  return found == object.end() ? *kNull : *found;
}

// The element when there are so many, else null.
const JsonValue& ElementOf(const JsonValue& array, std::size_t index) {
  static const JsonValue* const kNull = new JsonValue;
  return array.is_array() && index < array.size() ? array[index] : *kNull;
}

bool ReadNumbers(const JsonValue& array, std::size_t count, double* out) {
  if (!array.is_array() || array.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (!array[i].is_number()) return false;
    out[i] = array[i].get<double>();
  }
  return true;
}

bool ReadPoint(const JsonValue& array, Complex& out) {
  std::array<double, 2> xy{};
  if (!ReadNumbers(array, 2, xy.data())) return false;
  out = {xy[0], xy[1]};
  return true;
}

bool ReadIndex(const JsonValue& number, std::uint32_t& out) {
  if (!number.is_number_unsigned() || number.get<std::uint64_t>() > UINT32_MAX) return false;
  out = number.get<std::uint32_t>();
  return true;
}

// Optional members: false when one is there and is something else.
bool ReadOptional(const JsonValue& value, double& out) {
  if (value.is_number()) out = value.get<double>();
  return value.is_null() || value.is_number();
}
bool ReadOptional(const JsonValue& value, bool& out) {
  if (value.is_boolean()) out = value.get<bool>();
  return value.is_null() || value.is_boolean();
}
bool ReadOptional(const JsonValue& value, Outside& out) {
  bool snap = false;
  const bool good = ReadOptional(value, snap);
  if (snap) out = Outside::kSnap;
  return good;
}

// The fields beside name and anchor; each may be missing.
bool ReadFields(const JsonValue& json, TrackHandle& out) {
  out.own_weight = Member(json, "weight").is_number();
  return std::ranges::all_of(kHandleFields, [&](const HandleField& field) {
    const JsonValue& value = Member(json, field.name);
    return std::visit([&](auto member) { return ReadOptional(value, out.handle.*member); },
                      field.member);
  });
}

// Reads a text piece by piece. A fault has the place of the piece, which the steps to it say.
class TrackReader {
 public:
  TrackReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Result<Track> Read() {
    TRY(JsonValue json, ParseJson(text_, name_));
    if (!json.is_object()) return Bad({}, "not a JSON object");
    if (!Member(json, "handles").is_array() || !Member(json, "frames").is_array()) {
      return Bad({}, "a track needs the arrays \"handles\" and \"frames\"");
    }
    if (Member(json, "mesh").is_string()) track_.mesh = Member(json, "mesh").get<std::string>();
    if (const JsonValue& weight = Member(json, "w"); weight.is_number()) {
      track_.row_weight = weight.get<double>();
    }
    CHECK_OK(ReadRigidity(Member(json, "rigidity")));
    CHECK_OK(ReadHandles(Member(json, "handles")));
    CHECK_OK(ReadEdits(Member(json, "edits")));
    track_.frames.resize(Member(json, "frames").size());
    CHECK_OK(CheckEdits());
    CHECK_OK(ReadFrames(std::move(json["frames"])));
    return std::move(track_);
  }

 private:
  using Steps = std::vector<JsonStep>;

  tl::unexpected<Fault> Bad(const Steps& steps, const std::string& message) const {
    return Fail(FaultKind::kInvalidOption, JsonPlace(text_, name_, steps) + ": " + message);
  }

  Status ReadRigidity(const JsonValue& rigidity) {
    if (rigidity.is_null()) return {};
    track_.rigidity.resize(rigidity.size());
    if (ReadNumbers(rigidity, rigidity.size(), track_.rigidity.data())) return {};
    return Bad({"rigidity"}, "\"rigidity\" is not an array of numbers");
  }

  Status ReadHandles(const JsonValue& handles) {
    CHECK_OK(CheckCount(handles.size(), {"handles"}));
    track_.handles.reserve(handles.size());
    for (const JsonValue& entry : handles) {
      const std::size_t k = track_.handles.size();
      TRY(TrackHandle handle, ReadHandle(entry, {"handles", k}, fmt::format("handle {}", k), k));
      track_.handles.push_back(std::move(handle));
    }
    return {};
  }

  Status CheckCount(std::size_t handles, const Steps& steps) const {
    if (handles <= kMaxTrackHandles) return {};
    return Bad(steps, fmt::format("{} handles; a track may have {}", handles, kMaxTrackHandles));
  }

  // `number` names a handle without a name, `what` is the handle in faults.
  Result<TrackHandle> ReadHandle(const JsonValue& json, const Steps& steps, const std::string& what,
                                 std::size_t number) const {
    TrackHandle out;
    const JsonValue& name = Member(json, "name");
    out.handle.id = name.is_string() ? name.get<std::string>() : fmt::format("h{}", number);
    if (!ReadPoint(Member(json, "rest"), out.rest)) {
      return Bad(steps, what + " needs \"rest\": [x, y]");
    }
    if (!Member(json, "triangle").is_null()) {
      TriangleAnchor anchor;
      if (!ReadIndex(Member(json, "triangle"), anchor.triangle) ||
          !ReadNumbers(Member(json, "bary"), 3, anchor.barycentric.data())) {
        return Bad(steps, what + " needs \"triangle\": index with \"bary\": [a, b, c]");
      }
      out.handle.anchor = anchor;
    } else if (!Member(json, "vertex").is_null()) {
      VertexAnchor anchor;
      if (!ReadIndex(Member(json, "vertex"), anchor.vertex)) {
        return Bad(steps, what + ": \"vertex\" is not an index");
      }
      out.handle.anchor = anchor;
    } else {
      out.handle.anchor = PointAnchor{out.rest};
    }
    if (!ReadFields(json, out)) {
      return Bad(steps, what +
                            ": weight, area_radius, depth and depth_falloff are numbers; hard, "
                            "oriented and snap are true or false");
    }
    return out;
  }

  // `number` is that of the first handle that it adds.
  Result<TrackEdit> ReadEdit(const JsonValue& json, std::size_t index, std::size_t number) const {
    const JsonValue& remove = Member(json, "remove");
    const JsonValue& add = Member(json, "add");
    const auto bad = [&](const char* what) {
      return Bad({"edits", index}, fmt::format("edit {}{}", index, what));
    };
    std::uint32_t frame = 0;
    if (!ReadIndex(Member(json, "frame"), frame) || (remove.empty() && add.empty())) {
      return bad(" needs \"frame\": index and \"remove\" or \"add\"");
    }
    TrackEdit edit{frame, {}, {}};
    if (!(remove.is_null() || remove.is_array()) || !(add.is_null() || add.is_array())) {
      return bad(": \"remove\" and \"add\" are arrays");
    }
    for (const JsonValue& id : remove) {
      if (!id.is_string()) return bad(": \"remove\" has names");
      edit.remove.push_back(id.get<std::string>());
    }
    for (const JsonValue& entry : add) {
      const std::size_t k = edit.add.size();
      TRY(TrackHandle handle, ReadHandle(entry, {"edits", index, "add", k},
                                         fmt::format("edit {}: handle {}", index, k), number + k));
      edit.add.push_back(std::move(handle));
    }
    return edit;
  }

  Status ReadEdits(const JsonValue& edits) {
    if (!edits.is_null() && !edits.is_array()) return Bad({"edits"}, "\"edits\" is not an array");
    std::size_t number = track_.handles.size();
    for (const JsonValue& entry : edits) {
      TRY(TrackEdit edit, ReadEdit(entry, track_.edits.size(), number));
      number += edit.add.size();
      CHECK_OK(CheckCount(number, {"edits", track_.edits.size(), "add"}));
      track_.edits.push_back(std::move(edit));
    }
    return {};
  }

  // Frames grow and are those of the track; what is removed is there.
  Status CheckEdits() const {
    std::set<std::string> ids;
    for (const TrackHandle& entry : track_.handles) ids.insert(entry.handle.id);
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < track_.edits.size(); ++i) {
      const TrackEdit& edit = track_.edits[i];
      if (edit.frame >= track_.frames.size() || (last && edit.frame <= *last)) {
        return Bad({"edits", i, "frame"},
                   fmt::format("edit {}: the frames of edits are frames of the track and grow", i));
      }
      last = edit.frame;
      for (const std::string& id : edit.remove) {
        if (ids.erase(id) == 0) {
          return Bad({"edits", i, "remove"},
                     fmt::format("edit {} removes \"{}\", which is not there", i, id));
        }
      }
      for (const TrackHandle& entry : edit.add) ids.insert(entry.handle.id);
    }
    return {};
  }

  // Each is given back when it is read.
  Status ReadFrames(JsonValue frames) {
    const auto start_at_rest = [&](const std::vector<TrackHandle>& entries) {
      for (const TrackHandle& entry : entries) last_.push_back({entry.rest});
    };
    start_at_rest(track_.handles);
    for (const TrackEdit& edit : track_.edits) start_at_rest(edit.add);
    TrackSegments segments(track_);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      TRY(track_.frames[i], ReadFrame(frames[i], i, segments.At(i)));
      frames[i] = nullptr;
    }
    if (kept_ > 0) {
      track_.warnings.push_back(
          {"kept_targets",
           kept_,
           {},
           fmt::format("{}: {} targets are null or missing, the first that of {}; a handle without "
                       "one keeps what it had before",
                       name_, kept_, first_kept_)});
    }
    return {};
  }

  Result<TrackFrame> ReadFrame(const JsonValue& json, std::size_t index,
                               const TrackSegment& segment) {
    const std::size_t count = segment.ids.size();
    TrackFrame frame;
    const JsonValue& kind = Member(json, "kind");
    if (kind.is_string()) frame.kind = kind.get<std::string>();
    const JsonValue& targets = Member(json, "targets");
    if (!targets.is_array() || targets.size() > count) {
      return Bad({"frames", index, "targets"},
                 fmt::format("frame {} needs \"targets\" with a pair or null for each of {} "
                             "handles",
                             index, count));
    }
    const JsonValue& angles = Member(json, "angles");
    const JsonValue& scales = Member(json, "scales");
    for (const auto& [name, list] : {std::pair("angles", &angles), std::pair("scales", &scales)}) {
      if (list->is_null() || (list->is_array() && list->size() <= count)) continue;
      return Bad({"frames", index, name},
                 fmt::format("frame {}: angles and scales have one number per handle", index));
    }
    frame.targets.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      Target& target = last_[segment.numbers[k]];
      // A list that ends early costs nothing to write, so that a short text could ask for any amount.
      if (k >= targets.size() && ++missing_ > kMissingTargets + text_.size() / 8) {
        return Bad({"frames", index, "targets"},
                   fmt::format("frame {}: more than {} targets are missing at the ends of lists; "
                               "write null for each",
                               index, missing_ - 1));
      }
      bool kept = ElementOf(targets, k).is_null();
      if (!kept) {
        if (angles.is_null()) target.angle = 0;
        if (scales.is_null()) target.scale = 1;
        if (!ReadPoint(targets[k], target.position)) {
          return Bad({"frames", index, "targets", k},
                     fmt::format("frame {}: target {} is neither [x, y] nor null", index, k));
        }
      }
      const auto read = [&](const char* name, const JsonValue& list, double& out) -> Status {
        const JsonValue& entry = ElementOf(list, k);
        if (entry.is_null() && !list.is_null()) kept = true;
        if (ReadOptional(entry, out)) return {};
        return Bad(
            {"frames", index, name, k},
            fmt::format("frame {}: element {} of {} is neither a number nor null", index, k, name));
      };
      CHECK_OK(read("angles", angles, target.angle));
      CHECK_OK(read("scales", scales, target.scale));
      if (kept && kept_++ == 0) {
        first_kept_ = fmt::format("handle \"{}\" in frame {}", segment.ids[k], index);
      }
      frame.targets.push_back(target);
    }
    return frame;
  }

  const std::string_view text_;
  const std::string& name_;
  Track track_;
  std::vector<Target> last_;  // by the number of the handle
  std::size_t missing_ = 0;   // targets at the ends of lists
  std::size_t kept_ = 0;      // targets that were not there, or not whole
  std::string first_kept_;    // and whose was the first
};

}  // namespace

Result<Track> ParseTrack(std::string_view json, const std::string& name) {
  return TrackReader(json, name).Read();
}

Result<Track> ReadTrack(const std::string& path) {
  TRY(const std::string text, ReadTextFile(path));
  return ParseTrack(text, path);
}

}  // namespace arap
