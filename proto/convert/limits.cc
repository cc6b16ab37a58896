#include "proto/convert/limits.h"

#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/duration.pb.h>

#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

using google::protobuf::Duration;
using google::protobuf::FieldDescriptor;
using google::protobuf::Reflection;
using std::chrono::milliseconds;

// Every limit that is served has a field; a test compares the two lists.
const FieldDescriptor* FieldOf(const LimitInfo& info) {
  return v1::Limits::descriptor()->FindFieldByName(std::string(info.name));
}

struct Writer {
  v1::Limits* out;
  const FieldDescriptor* field;
  const Reflection* reflection = v1::Limits::GetReflection();

  void operator()(std::size_t value) const { reflection->SetUInt64(out, field, value); }
  void operator()(std::uint32_t value) const { reflection->SetUInt32(out, field, value); }
  void operator()(double value) const { reflection->SetDouble(out, field, value); }
  void operator()(milliseconds value) const {
    ToWire(value, static_cast<Duration*>(reflection->MutableMessage(out, field)));
  }
};

struct Reader {
  const v1::Limits& in;
  const FieldDescriptor* field;
  const Reflection* reflection = v1::Limits::GetReflection();

  void operator()(std::size_t& value) const { value = reflection->GetUInt64(in, field); }
  void operator()(std::uint32_t& value) const { value = reflection->GetUInt32(in, field); }
  void operator()(double& value) const { value = reflection->GetDouble(in, field); }
  void operator()(milliseconds& value) const {
    const auto& duration = static_cast<const Duration&>(reflection->GetMessage(in, field));
    value = std::chrono::duration_cast<milliseconds>(FromWire(duration));
  }
};

}  // namespace

void ToWire(const Limits& limits, v1::Limits* out) {
  for (const LimitInfo& info : kLimits) {
    if (info.served) VisitLimit(limits, info, Writer{out, FieldOf(info)});
  }
}

Limits FromWire(const v1::Limits& in) {
  Limits limits;
  for (const LimitInfo& info : kLimits) {
    if (info.served) {
      VisitLimit(limits, info, Reader{in, FieldOf(info)});
    } else {
      VisitLimit(limits, info, [](auto& value) { value = {}; });
    }
  }
  return limits;
}

}  // namespace arap::convert
