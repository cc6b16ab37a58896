#include "server/store/record_reader.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace arap::store {

const RecordReader::Json& RecordReader::At(const Json& json, const char* name) {
  static const Json& nothing = *new Json;
  if (!Check(json.is_object())) return nothing;
  const auto found = json.find(name);
  return Check(found != json.end()) ? *found : nothing;
}

const RecordReader::Json& RecordReader::Array(const Json& json, const char* name) {
  static const Json& empty = *new Json(Json::array());
  const Json& at = At(json, name);
  return Check(at.is_array()) ? at : empty;
}

const RecordReader::Json& RecordReader::Object(const Json& json, const char* name) {
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

}  // namespace arap::store
