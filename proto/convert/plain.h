// The plain pieces of messages: arrays of numbers as points and groups, times, values of
// enumerations.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <google/protobuf/repeated_field.h>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace google::protobuf {
class Duration;
class Timestamp;
}  // namespace google::protobuf

namespace arap::convert {

template <class Number>
using Array = google::protobuf::RepeatedField<Number>;

template <class To, class From>
std::vector<To> Values(const Array<From>& from) {
  return std::vector<To>(from.begin(), from.end());
}

// x y x y… as points; the last number of an odd length is left out.
template <class Number>
std::vector<Complex> Points(const Array<Number>& numbers) {
  std::vector<Complex> points(static_cast<std::size_t>(numbers.size() / 2));
  const Number* next = numbers.data();
  for (Complex& point : points) {
    point = {static_cast<double>(next[0]), static_cast<double>(next[1])};
    next += 2;
  }
  return points;
}

// Numbers in groups of a fixed size; what does not fill the last group is left out.
template <class To, std::size_t kCount, class From>
std::vector<std::array<To, kCount>> Groups(const Array<From>& numbers) {
  std::vector<std::array<To, kCount>> groups(static_cast<std::size_t>(numbers.size()) / kCount);
  const From* next = numbers.data();
  for (std::array<To, kCount>& group : groups) {
    std::copy_n(next, kCount, group.begin());
    next += kCount;
  }
  return groups;
}

template <class Number, class Range>
void Append(const Range& values, Array<Number>* out) {
  out->Add(values.begin(), values.end());
}

template <class Number>
void AppendPoints(std::span<const Complex> points, Array<Number>* out) {
  out->Reserve(out->size() + static_cast<int>(2 * points.size()));
  for (const Complex point : points) {
    out->AddAlreadyReserved(static_cast<Number>(point.real()));
    out->AddAlreadyReserved(static_cast<Number>(point.imag()));
  }
}

template <class Number, class From, std::size_t kCount>
void AppendGroups(const std::vector<std::array<From, kCount>>& groups, Array<Number>* out) {
  out->Reserve(out->size() + static_cast<int>(kCount * groups.size()));
  for (const auto& group : groups) {
    for (const From value : group) out->AddAlreadyReserved(static_cast<Number>(value));
  }
}

// Positions of a result, x y x y…, in place of what `out` holds; as floats less an origin. kNumerical
// when one is not finite in the precision of the field; `out` is then empty.
Status PackPoints(std::span<const Complex> points, Array<float>* out, Complex origin = {});
Status PackPoints(std::span<const Complex> points, Array<double>* out);

// kInvalidOption for a value of an enumeration that this version does not know.
Fault UnknownValue(const std::string& field, int value);

// A value of an enumeration on the wire and in the model. A table has a row for every value of the
// wire but the first, "unspecified".
template <class Wire, class Model>
struct EnumRow {
  Wire wire;
  Model model;
};

template <class Wire, class Model, std::size_t kRows>
Wire WireOf(const EnumRow<Wire, Model> (&table)[kRows], Model value) {
  for (const auto& row : table) {
    if (row.model == value) return row.wire;
  }
  return Wire{};
}

// `unspecified` is what is meant where nothing is said. Fault: UnknownValue's.
template <class Wire, class Model, std::size_t kRows>
Result<Model> ModelOf(const EnumRow<Wire, Model> (&table)[kRows], Wire value, Model unspecified,
                      const std::string& field) {
  if (value == Wire{}) return unspecified;
  for (const auto& row : table) {
    if (row.wire == value) return row.model;
  }
  return Fail(UnknownValue(field, value));
}

// kArrayLength unless `length` is a multiple of `group`.
Status CheckGroups(int length, int group, const std::string& field);

using WallTime = std::chrono::system_clock::time_point;

// Times of more than 285 years, or that long before or after 1970, are cut to that.
std::chrono::nanoseconds FromWire(const google::protobuf::Duration& duration);
void ToWire(std::chrono::nanoseconds duration, google::protobuf::Duration* out);

WallTime FromWire(const google::protobuf::Timestamp& time);
void ToWire(WallTime time, google::protobuf::Timestamp* out);

double Micros(const google::protobuf::Duration& duration);
void SetMicros(double micros, google::protobuf::Duration* out);

}  // namespace arap::convert
