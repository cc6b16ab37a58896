#include "proto/convert/plain.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <google/protobuf/duration.pb.h>
#include <google/protobuf/timestamp.pb.h>

namespace arap::convert {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

template <class Number>
Status Pack(std::span<const Complex> points, Complex origin, Array<Number>* out) {
  constexpr auto kLargest = static_cast<double>(std::numeric_limits<Number>::max());
  out->Resize(static_cast<int>(2 * points.size()), 0);
  Number* next = out->mutable_data();
  bool finite = true;
  const double x0 = origin.real(), y0 = origin.imag();
  // By reference: g++ 12 puts a copy on the stack and waits for it, ten times as long as the rest takes.
  for (const Complex& point : points) {
    const double x = point.real() - x0, y = point.imag() - y0;
    // Written so that NaN fails too.
    finite = finite && std::abs(x) <= kLargest && std::abs(y) <= kLargest;
    if (!finite) break;
    *next++ = static_cast<Number>(x);
    *next++ = static_cast<Number>(y);
  }
  if (finite) return {};
  out->Clear();
  return Fail(FaultKind::kNumerical, "A position of the result is not finite in this precision.");
}

// What 64 bits can say in nanoseconds, some 290 years, whatever was sent.
nanoseconds Within(std::int64_t whole, std::int32_t rest) {
  constexpr std::int64_t kMost = 9'000'000'000;
  return seconds(std::clamp(whole, -kMost, kMost)) + nanoseconds(rest);
}

template <class Message>
void Set(seconds whole, nanoseconds rest, Message* out) {
  out->set_seconds(whole.count());
  out->set_nanos(static_cast<std::int32_t>(rest.count()));
}

}  // namespace

Status PackPoints(std::span<const Complex> points, Array<float>* out, Complex origin) {
  return Pack(points, origin, out);
}

Status PackPoints(std::span<const Complex> points, Array<double>* out) {
  return Pack(points, {}, out);
}

Fault UnknownValue(const std::string& field, int value) {
  return Fault(FaultKind::kInvalidOption,
               fmt::format("{} has the value {}, which this version does not know.", field, value))
      .Field(field)
      .Detail("value", value);
}

Status CheckGroups(int length, int group, const std::string& field) {
  if (length % group == 0) return {};
  return Fail(Fault(FaultKind::kArrayLength,
                    fmt::format("{} has {} numbers, not a multiple of {}.", field, length, group))
                  .Field(field)
                  .Detail("length", length)
                  .Detail("expected", fmt::format("a multiple of {}", group)));
}

nanoseconds FromWire(const google::protobuf::Duration& duration) {
  return Within(duration.seconds(), duration.nanos());
}

void ToWire(nanoseconds duration, google::protobuf::Duration* out) {
  // Both parts of a Duration have one sign.
  Set(std::chrono::duration_cast<seconds>(duration), duration % seconds(1), out);
}

WallTime FromWire(const google::protobuf::Timestamp& time) {
  const nanoseconds since = Within(time.seconds(), time.nanos());
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
