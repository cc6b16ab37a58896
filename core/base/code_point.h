// The characters of UTF-8 text, one after the other, whoever it comes from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace arap {

// The character that a text begins with, which is not empty. A byte that is no UTF-8 stands for
// itself.
struct CodePoint {
  std::uint32_t value = 0;
  std::size_t length = 1;  // bytes
  bool valid = false;

  explicit CodePoint(std::string_view text);

  // Neither a control character, nor one that is not seen or changes how others are shown.
  bool IsHarmless() const;
};

}  // namespace arap
