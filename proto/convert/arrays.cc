#include "proto/convert/arrays.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace arap::convert {
namespace {

template <class Number>
Status Pack(std::span<const Complex> points, Array<Number>* out) {
  constexpr auto kLargest = static_cast<double>(std::numeric_limits<Number>::max());
  out->Resize(static_cast<int>(2 * points.size()), 0);
  Number* next = out->mutable_data();
  bool finite = true;
  for (const Complex point : points) {
    // Written so that NaN fails too.
    finite = finite && std::abs(point.real()) <= kLargest && std::abs(point.imag()) <= kLargest;
    if (!finite) break;
    *next++ = static_cast<Number>(point.real());
    *next++ = static_cast<Number>(point.imag());
  }
  if (finite) return {};
  out->Clear();
  return Fail(FaultKind::kNumerical, "A position of the result is not finite in this precision.");
}

}  // namespace

Status PackPoints(std::span<const Complex> points, Array<float>* out) { return Pack(points, out); }

Status PackPoints(std::span<const Complex> points, Array<double>* out) { return Pack(points, out); }

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

}  // namespace arap::convert
