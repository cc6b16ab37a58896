// What every answer must keep, whatever was asked. A broken promise ends the process, so that the
// fuzzer keeps the input.
#pragma once

#include <span>
#include <string>

#include "arap/base/fault.h"
#include "arap/model/mesh.h"

namespace google::protobuf {
class Message;
}
namespace grpc {
class Status;
}

namespace arap::fuzz {

[[noreturn]] void Broken(const char* promise, const char* details);

inline void Promise(bool kept, const char* promise, const char* details = "") {
  if (!kept) Broken(promise, details);
}

// Every number of it is finite.
void CheckFinite(const google::protobuf::Message& message);
void CheckFinite(std::span<const Complex> points, const char* what);
void CheckFinite(double number, const char* what);

// The end of a stream came in time, says something unless it is a success, and is no bug of ours.
void CheckEnd(const grpc::Status& status);
// Whether a status of this code, its details in bytes, is a bug. NUMERICAL is INTERNAL too, and no
// bug: extreme numbers may have no finite answer.
bool IsBug(int code, const std::string& details);

// It says something, names no more elements than it may, and is no bug of ours (kInternal).
void CheckFault(const Fault& fault);

}  // namespace arap::fuzz
