// Sessions and times between the wire and the server.
#pragma once

#include <chrono>

#include "arap/base/result.h"
#include "server/sessions/session.h"

namespace google::protobuf {
class Duration;
}
namespace arap::v1 {
class CreateSessionRequest;
class Session;
}  // namespace arap::v1

namespace arap::rpc {

// A ttl that is not set is 0. kInvalidOption for a ttl that no number of milliseconds can say.
Result<app::SessionSpec> FromWire(const v1::CreateSessionRequest& request);
void ToWire(const app::SessionView& view, v1::Session* out);

void SetDuration(std::chrono::nanoseconds time, google::protobuf::Duration* out);
void SetMicros(double micros, google::protobuf::Duration* out);

}  // namespace arap::rpc
