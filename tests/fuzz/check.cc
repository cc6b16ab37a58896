#include "tests/fuzz/check.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/support/status.h>

namespace arap::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

void CheckField(const Message& message, const FieldDescriptor* field) {
  const auto* reflection = message.GetReflection();
  const int count = field->is_repeated() ? reflection->FieldSize(message, field) : 1;
  for (int i = 0; i < count; ++i) {
    const bool repeated = field->is_repeated();
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        CheckFinite(repeated ? reflection->GetRepeatedDouble(message, field, i)
                             : reflection->GetDouble(message, field),
                    field->full_name().c_str());
        break;
      case FieldDescriptor::CPPTYPE_FLOAT:
        CheckFinite(static_cast<double>(repeated ? reflection->GetRepeatedFloat(message, field, i)
                                                 : reflection->GetFloat(message, field)),
                    field->full_name().c_str());
        break;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        CheckFinite(repeated ? reflection->GetRepeatedMessage(message, field, i)
                             : reflection->GetMessage(message, field));
        break;
      default:
        break;
    }
  }
}

}  // namespace

void Broken(const char* promise, const char* details) {
  std::fprintf(stderr, "BROKEN PROMISE: %s: %s\n", promise, details);
  std::abort();
}

void CheckFinite(const Message& message) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) CheckField(message, field);
}

void CheckFinite(std::span<const Complex> points, const char* what) {
  for (const Complex& point : points) {
    CheckFinite(point.real(), what);
    CheckFinite(point.imag(), what);
  }
}

void CheckFinite(double number, const char* what) {
  Promise(std::isfinite(number), "finite in, finite out", what);
}

bool IsBug(int code, const std::string& details) {
  return code == grpc::INTERNAL && details.find("NUMERICAL") == std::string::npos;
}

void CheckEnd(const grpc::Status& status) {
  Promise(status.error_code() != grpc::DEADLINE_EXCEEDED, "a stream ends", "hangs");
  Promise(!IsBug(status.error_code(), status.error_details()), "no input shows a bug",
          status.error_message().c_str());
  Promise(status.ok() || !status.error_message().empty(), "a fault has a message");
}

void CheckFault(const Fault& fault) {
  Promise(!fault.message.empty(), "a fault has a message", FaultName(fault.kind).c_str());
  Promise(fault.kind != FaultKind::kInternal, "no input shows a bug", fault.message.c_str());
  Promise(fault.elements.size() <= Fault::kMaxElements, "a fault names few elements",
          fault.message.c_str());
}

}  // namespace arap::fuzz
