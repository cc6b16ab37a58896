// What the parts of every answer have to be: finite, in range, as many as were asked for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "client/src/answers.h"
#include "core/base/plane.h"

namespace arap::client::internal {

// The fault for an answer that is not.
template <class... Arguments>
auto Bad(fmt::format_string<Arguments...> sentence, Arguments&&... arguments) {
  return Fail(BadAnswer(fmt::format(sentence, std::forward<Arguments>(arguments)...)));
}

inline Status CheckFinite(std::span<const Complex> points, const char* what) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!IsFinite(points[i])) return Bad("The server answered {} {} that is not finite.", what, i);
  }
  return {};
}

inline Status CheckNumbers(std::initializer_list<double> numbers, const char* what) {
  const bool finite = std::all_of(numbers.begin(), numbers.end(),
                                  [](double number) { return std::isfinite(number); });
  if (!finite) return Bad("The server answered a number of {} that is not finite.", what);
  return {};
}

// `what` says what there are so many of, `expected` of them being right.
inline Status CheckCount(std::size_t count, std::size_t expected, const char* what) {
  if (count == expected) return {};
  return Bad("The server answered {} {}, not {}.", count, what, expected);
}

template <class Indices>
inline Status CheckIndices(const Indices& indices, std::size_t limit, const char* what) {
  for (const std::uint32_t index : indices) {
    if (index >= limit) {
      return Bad("The server answered {} {}, but there are only {}.", what, index, limit);
    }
  }
  return {};
}

}  // namespace arap::client::internal
