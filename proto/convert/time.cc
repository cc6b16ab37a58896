#include "proto/convert/time.h"

#include <cstdint>

#include <google/protobuf/duration.pb.h>
#include <google/protobuf/timestamp.pb.h>

namespace arap::convert {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

template <class Message>
void Set(seconds whole, nanoseconds rest, Message* out) {
  out->set_seconds(whole.count());
  out->set_nanos(static_cast<std::int32_t>(rest.count()));
}

}  // namespace

nanoseconds FromWire(const google::protobuf::Duration& duration) {
  return seconds(duration.seconds()) + nanoseconds(duration.nanos());
}

void ToWire(nanoseconds duration, google::protobuf::Duration* out) {
  // Both parts of a Duration have one sign.
  Set(std::chrono::duration_cast<seconds>(duration), duration % seconds(1), out);
}

WallTime FromWire(const google::protobuf::Timestamp& time) {
  const auto since = seconds(time.seconds()) + nanoseconds(time.nanos());
  return WallTime(std::chrono::duration_cast<WallTime::duration>(since));
}

void ToWire(WallTime time, google::protobuf::Timestamp* out) {
  // The nanoseconds of a Timestamp count up, before 1970 too.
  const nanoseconds since = time.time_since_epoch();
  const auto whole = std::chrono::floor<seconds>(since);
  Set(whole, since - whole, out);
}

double Micros(const google::protobuf::Duration& duration) {
  return std::chrono::duration<double, std::micro>(FromWire(duration)).count();
}

void SetMicros(double micros, google::protobuf::Duration* out) {
  ToWire(nanoseconds(static_cast<std::int64_t>(micros * 1e3)), out);
}

}  // namespace arap::convert
