// Times between std::chrono and the wire.
#pragma once

#include <chrono>

namespace google::protobuf {
class Duration;
class Timestamp;
}  // namespace google::protobuf

namespace arap::convert {

using WallTime = std::chrono::system_clock::time_point;

std::chrono::nanoseconds FromWire(const google::protobuf::Duration& duration);
void ToWire(std::chrono::nanoseconds duration, google::protobuf::Duration* out);

WallTime FromWire(const google::protobuf::Timestamp& time);
void ToWire(WallTime time, google::protobuf::Timestamp* out);

double Micros(const google::protobuf::Duration& duration);
void SetMicros(double micros, google::protobuf::Duration* out);

}  // namespace arap::convert
