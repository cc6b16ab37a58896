#include "client/cli/load/document_reader.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/report.h"

namespace arap::cli {

std::string DocumentReader::Join(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

void DocumentReader::Wrong(const std::string& path, std::string_view what) {
  if (fault_) return;
  fault_ = Fault(FaultKind::kInvalidOption, fmt::format("{} {}.", path, what)).Field(path);
}

const DocumentReader::Json* DocumentReader::Member(const Json& object, const std::string& path,
                                                   const std::string& name) {
  if (fault_) return nullptr;
  if (object.is_object()) {
    if (const auto found = object.find(name); found != object.end()) return &*found;
  }
  Wrong(Join(path, name), "is not there");
  return nullptr;
}

const DocumentReader::Json* DocumentReader::Member(const Json& object, const std::string& path,
                                                   const std::string& name, Json::value_t type) {
  const Json* const member = Member(object, path, name);
  if (member == nullptr || member->type() == type) return member;
  Wrong(Join(path, name), type == Json::value_t::array ? "is no list" : "is no object");
  return nullptr;
}

void DocumentReader::Read(const Json& object, const std::string& path, const std::string& name,
                          double& value) {
  const Json* const member = Member(object, path, name);
  if (member == nullptr) return;
  if (!member->is_number() || !(member->get<double>() >= 0)) {
    return Wrong(Join(path, name), "is no number from 0 on");
  }
  value = member->get<double>();
}

void DocumentReader::Read(const Json& object, const std::string& path, const std::string& name,
                          bool& value) {
  const Json* const member = Member(object, path, name);
  if (member == nullptr) return;
  if (!member->is_boolean()) return Wrong(Join(path, name), "is neither true nor false");
  value = member->get<bool>();
}

void DocumentReader::Read(const Json& object, const std::string& path, const std::string& name,
                          std::string& value) {
  const Json* const member = Member(object, path, name);
  if (member == nullptr) return;
  if (!member->is_string()) return Wrong(Join(path, name), "is no text");
  value = Printable(member->get_ref<const std::string&>());
}

void DocumentReader::Read(const Json& object, const std::string& path, const std::string& name,
                          Histogram& value) {
  const std::string here = Join(path, name);
  const Json* const times = Member(object, path, name, Json::value_t::object);
  if (times == nullptr) return;
  double min = 0, max = 0, sum = 0;
  Read(*times, here, "min", min);
  Read(*times, here, "max", max);
  Read(*times, here, "sum", sum);
  const Json* const buckets = Member(*times, here, "buckets", Json::value_t::object);
  if (buckets == nullptr) return;
  std::vector<Histogram::Bucket> read;
  for (const auto& [low, count] : buckets->items()) {
    const char* const end = low.data() + low.size();
    Histogram::Bucket& bucket = read.emplace_back();
    const auto [stop, error] = std::from_chars(low.data(), end, bucket.low);
    if (error != std::errc() || stop != end || !count.is_number_unsigned()) {
      return Wrong(here + ".buckets", "has something that is no bucket");
    }
    bucket.count = count.get<std::uint64_t>();
  }
  // Members of an object have no order.
  std::sort(read.begin(), read.end(),
            [](const auto& one, const auto& other) { return one.low < other.low; });
  auto histogram = Histogram::Of(read, min, max, sum);
  if (!histogram) return Wrong(here, "is no histogram that arapctl has written");
  value = std::move(*histogram);
}

}  // namespace arap::cli
