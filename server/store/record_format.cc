#include "server/store/record_format.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace arap::store {
namespace {

using Json = nlohmann::json;

// Grows when a reader of the format before could not make the session of a record. Members that it
// may do without are added under the same number.
constexpr std::uint64_t kFormat = 1;

// Takes JSON apart without trusting it. Every read of a value that is missing or of another type
// leaves its target as it was and makes the reader bad for good; so one question at the end is
// enough. Never throws.
class RecordReader {
 public:
  bool good() const { return good_; }
  bool Check(bool condition) {
    good_ = good_ && condition;
    return condition;
  }

  // The member `name`, null when there is none.
  const Json& At(const Json& json, const char* name);
  // The same, an empty array or object when it is nothing of the kind.
  const Json& Array(const Json& json, const char* name);
  const Json& Object(const Json& json, const char* name);

  void Bool(const Json& json, const char* name, bool& value);
  void String(const Json& json, std::string& value);
  void String(const Json& json, const char* name, std::string& value) {
    String(At(json, name), value);
  }
  // A number, or 16 hexadecimal digits with the bits of one that is not finite.
  void Double(const Json& json, double& value);

  // An integer that fits.
  template <class T>
  void Number(const Json& json, const char* name, T& value) {
    static_assert(std::is_integral_v<T>);
    const Json& at = At(json, name);
    if (at.is_number_unsigned()) {
      const auto number = at.get<Json::number_unsigned_t>();
      if (Check(std::in_range<T>(number))) value = static_cast<T>(number);
    } else if (Check(at.is_number_integer())) {
      const auto number = at.get<Json::number_integer_t>();
      if (Check(std::in_range<T>(number))) value = static_cast<T>(number);
    }
  }

 private:
  bool good_ = true;
};

const Json& RecordReader::At(const Json& json, const char* name) {
  static const Json& nothing = *new Json;
  if (!Check(json.is_object())) return nothing;
  const auto found = json.find(name);
  return Check(found != json.end()) ? *found : nothing;
}

const Json& RecordReader::Array(const Json& json, const char* name) {
  static const Json& empty = *new Json(Json::array());
  const Json& at = At(json, name);
  return Check(at.is_array()) ? at : empty;
}

const Json& RecordReader::Object(const Json& json, const char* name) {
  static const Json& empty = *new Json(Json::object());
  const Json& at = At(json, name);
  return Check(at.is_object()) ? at : empty;
}

void RecordReader::Bool(const Json& json, const char* name, bool& value) {
  const Json& at = At(json, name);
  if (Check(at.is_boolean())) value = at.get<bool>();
}

void RecordReader::String(const Json& json, std::string& value) {
  if (Check(json.is_string())) value = json.get_ref<const std::string&>();
}

void RecordReader::Double(const Json& json, double& value) {
  if (json.is_number()) {
    value = json.get<double>();
    return;
  }
  if (!Check(json.is_string())) return;
  const auto& digits = json.get_ref<const std::string&>();
  const char* end = digits.data() + digits.size();
  std::uint64_t bits = 0;
  const auto read = std::from_chars(digits.data(), end, bits, 16);
  if (!Check(digits.size() == 16 && read.ec == std::errc{} && read.ptr == end)) return;
  value = std::bit_cast<double>(bits);
  Check(!std::isfinite(value));
}

// JSON has no infinities.
Json ToJson(double number) {
  if (std::isfinite(number)) return number;
  return fmt::format("{:016x}", std::bit_cast<std::uint64_t>(number));
}

Json AnchorToJson(const Handle& handle) {
  if (const auto* vertex = std::get_if<VertexAnchor>(&handle.anchor)) {
    return {{"vertex", vertex->vertex}};
  }
  if (const auto* triangle = std::get_if<TriangleAnchor>(&handle.anchor)) {
    Json weights = Json::array();
    for (const double weight : triangle->barycentric) weights.push_back(ToJson(weight));
    return {{"triangle", triangle->triangle}, {"barycentric", std::move(weights)}};
  }
  const Complex at = std::get<PointAnchor>(handle.anchor).position;
  return {{"x", ToJson(at.real())}, {"y", ToJson(at.imag())}};
}

Json HandleToJson(const Handle& handle) {
  const auto value = [&](auto member) -> Json {
    if constexpr (std::is_same_v<decltype(member), double Handle::*>) {
      return ToJson(handle.*member);
    } else if constexpr (std::is_same_v<decltype(member), bool Handle::*>) {
      return handle.*member;
    } else {
      return handle.*member == Outside::kSnap;
    }
  };
  Json json = {{"id", handle.id}, {"anchor", AnchorToJson(handle)}};
  for (const HandleField& field : kHandleFields) {
    json[field.name] = std::visit(value, field.member);
  }
  return json;
}

void ReadAnchor(RecordReader& reader, const Json& json, Handle& handle) {
  if (json.contains("vertex")) {
    VertexAnchor anchor;
    reader.Number(json, "vertex", anchor.vertex);
    handle.anchor = anchor;
  } else if (json.contains("triangle")) {
    TriangleAnchor anchor;
    reader.Number(json, "triangle", anchor.triangle);
    const Json& weights = reader.Array(json, "barycentric");
    if (!reader.Check(weights.size() == anchor.barycentric.size())) return;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      reader.Double(weights[i], anchor.barycentric[i]);
    }
    handle.anchor = anchor;
  } else {
    double x = 0, y = 0;
    reader.Double(reader.At(json, "x"), x);
    reader.Double(reader.At(json, "y"), y);
    handle.anchor = PointAnchor{{x, y}};
  }
}

Handle ReadHandle(RecordReader& reader, const Json& json) {
  Handle handle;
  reader.String(json, "id", handle.id);
  ReadAnchor(reader, reader.Object(json, "anchor"), handle);
  for (const HandleField& field : kHandleFields) {
    const auto read = [&](auto member) {
      if constexpr (std::is_same_v<decltype(member), double Handle::*>) {
        reader.Double(reader.At(json, field.name), handle.*member);
      } else if constexpr (std::is_same_v<decltype(member), bool Handle::*>) {
        reader.Bool(json, field.name, handle.*member);
      } else {
        bool snap = false;
        reader.Bool(json, field.name, snap);
        handle.*member = snap ? Outside::kSnap : Outside::kError;
      }
    };
    std::visit(read, field.member);
  }
  return handle;
}

HandleSetRecord ReadHandleSet(RecordReader& reader, const Json& json) {
  HandleSetRecord set;
  reader.String(json, "mesh_id", set.mesh_id);
  reader.Number(json, "revision", set.revision);
  std::vector<Handle> handles;
  for (const Json& handle : reader.Array(json, "handles")) {
    handles.push_back(ReadHandle(reader, handle));
  }
  set.definitions = MakeDefinitions(std::move(handles));
  return set;
}

Json FaultToJson(const Fault& fault) {
  Json details = Json::array();
  for (const auto& [name, value] : fault.details) details.push_back({name, value});
  return {{"reason", InfoOf(fault.kind).reason},
          {"message", fault.message},
          {"field", fault.field},
          {"elements", fault.elements},
          {"details", std::move(details)}};
}

// The reason of a later version is kInternal.
Fault ReadFault(RecordReader& reader, const Json& json) {
  std::string reason, message, field;
  reader.String(json, "reason", reason);
  reader.String(json, "message", message);
  reader.String(json, "field", field);
  Fault fault(KindOfReason(reason).value_or(FaultKind::kInternal), message);
  fault.Field(field);
  for (const Json& element : reader.Array(json, "elements")) {
    if (reader.Check(element.is_number_unsigned())) fault.Element(element.get<std::uint32_t>());
  }
  for (const Json& detail : reader.Array(json, "details")) {
    if (!reader.Check(detail.is_array() && detail.size() == 2)) continue;
    std::string name, value;
    reader.String(detail[0], name);
    reader.String(detail[1], value);
    fault.Detail(name, value);
  }
  return fault;
}

Json JobToJson(const JobRecord& job) {
  Json json = {{"request", job.request}, {"request_bytes", job.request_bytes}};
  if (!job.result.empty()) {
    json["result"] = job.result;
    json["result_bytes"] = job.result_bytes;
  }
  if (job.fault) json["fault"] = FaultToJson(*job.fault);
  return json;
}

JobRecord ReadJob(RecordReader& reader, const Json& json) {
  JobRecord job;
  reader.String(json, "request", job.request);
  reader.Number(json, "request_bytes", job.request_bytes);
  if (json.contains("result")) {
    reader.String(json, "result", job.result);
    reader.Number(json, "result_bytes", job.result_bytes);
  }
  if (json.contains("fault")) job.fault = ReadFault(reader, json["fault"]);
  return job;
}

SessionRecord ReadRecord(RecordReader& reader, const Json& json) {
  SessionRecord record;
  std::uint64_t format = 0;
  std::int64_t ttl = 0, created = 0, expires = 0;
  reader.Number(json, "format", format);
  reader.Check(format == kFormat);
  reader.String(json, "owner", record.key.owner);
  reader.String(json, "id", record.key.id);
  if (json.contains("incarnation")) reader.String(json, "incarnation", record.incarnation);
  reader.Number(json, "revision", record.revision);
  reader.Number(json, "ttl_ms", ttl);
  reader.Number(json, "created_ms", created);
  reader.Number(json, "expires_ms", expires);
  record.ttl = std::chrono::milliseconds(ttl);
  record.created = FromMillis(created);
  record.expires = FromMillis(expires);
  for (const auto& [key, value] : reader.Object(json, "labels").items()) {
    reader.String(value, record.labels[key]);
  }
  for (const auto& [id, mesh] : reader.Object(json, "meshes").items()) {
    MeshRecord& read = record.meshes[id];
    reader.String(mesh, "blob", read.blob);
    if (mesh.contains("bytes")) reader.Number(mesh, "bytes", read.bytes);
  }
  for (const auto& [id, set] : reader.Object(json, "handle_sets").items()) {
    record.handle_sets[id] = ReadHandleSet(reader, set);
  }
  if (json.is_object() && json.contains("jobs")) {
    for (const auto& [id, job] : reader.Object(json, "jobs").items()) {
      record.jobs[id] = ReadJob(reader, job);
    }
  }
  return record;
}

// 0 where none can be read.
std::uint64_t FormatOf(const Json& json) {
  RecordReader reader;
  std::uint64_t format = 0;
  reader.Number(json, "format", format);
  return format;
}

Json RecordToJson(const SessionRecord& record) {
  Json meshes = Json::object(), handle_sets = Json::object();
  for (const auto& [id, mesh] : record.meshes) {
    meshes[id] = {{"blob", mesh.blob}, {"bytes", mesh.bytes}};
  }
  for (const auto& [id, set] : record.handle_sets) {
    Json handles = Json::array();
    for (const Handle& handle : *set.definitions) handles.push_back(HandleToJson(handle));
    handle_sets[id] = {
        {"mesh_id", set.mesh_id}, {"revision", set.revision}, {"handles", std::move(handles)}};
  }
  Json labels = Json::object();
  for (const auto& [key, value] : record.labels) labels[key] = value;
  Json jobs = Json::object();
  for (const auto& [id, job] : record.jobs) jobs[id] = JobToJson(job);
  Json json = {{"format", kFormat},
               {"owner", record.key.owner},
               {"id", record.key.id},
               {"incarnation", record.incarnation},
               {"revision", record.revision},
               {"ttl_ms", record.ttl.count()},
               {"created_ms", ToMillis(record.created)},
               {"expires_ms", ToMillis(record.expires)},
               {"labels", std::move(labels)},
               {"meshes", std::move(meshes)},
               {"handle_sets", std::move(handle_sets)}};
  // Records without jobs read as they did before there were any.
  if (!jobs.empty()) json["jobs"] = std::move(jobs);
  return json;
}

}  // namespace

Result<std::string> EncodeRecord(const SessionRecord& record) {
  try {
    return RecordToJson(record).dump();
  } catch (const Json::exception&) {
    return Fail(FaultKind::kInternal, "A session record holds a string that is not UTF-8.");
  }
}

Result<SessionRecord> DecodeRecord(std::string_view text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (const std::uint64_t format = FormatOf(json); format > kFormat) {
    return Fail(Unavailable(
        fmt::format("a record was written by a later version, in format {} where this one reads {}",
                    format, kFormat)));
  }
  RecordReader reader;
  SessionRecord record = ReadRecord(reader, json);
  if (!reader.good()) {
    return Fail(FaultKind::kDataLoss,
                "A stored session record is not in the form of this version.");
  }
  return record;
}

}  // namespace arap::store
