#include "core/base/code_point.h"

#include <algorithm>
#include <array>

namespace arap {

CodePoint::CodePoint(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  value = at(0);
  valid = value < 0x80;
  if (value < 0xc2 || value > 0xf4) return;
  const std::size_t count = value < 0xe0 ? 2 : value < 0xf0 ? 3 : 4;
  if (text.size() < count) return;
  std::uint32_t whole = value & (0x7fU >> count);
  for (std::size_t i = 1; i < count; ++i) {
    if ((at(i) & 0xc0U) != 0x80) return;
    whole = whole << 6U | (at(i) & 0x3fU);
  }
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  if (whole < kLeast[count] || whole > 0x10ffff || (whole >= 0xd800 && whole < 0xe000)) return;
  value = whole;
  length = count;
  valid = true;
}

bool CodePoint::IsHarmless() const {
  struct Range {
    std::uint32_t first, last;
  };
  constexpr std::array<Range, 10> kHarmful{{{0, 0x1f},
                                            {0x7f, 0x9f},
                                            {0xad, 0xad},
                                            {0x61c, 0x61c},
                                            {0x200b, 0x200f},
                                            {0x2028, 0x202e},
                                            {0x2060, 0x206f},
                                            {0xfeff, 0xfeff},
                                            {0xfffe, 0xffff},
                                            {0xe0000, 0xe0fff}}};
  return valid && std::none_of(kHarmful.begin(), kHarmful.end(), [this](const Range& range) {
           return value >= range.first && value <= range.last;
         });
}

}  // namespace arap
