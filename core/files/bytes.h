// Bytes taken apart number by number, and the sentence for what is wrong at one of them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

enum class ByteOrder : std::uint8_t { kLittle, kBig };

// The number that begins at a byte. The bytes are there.
template <class Number>
Number NumberAt(std::string_view bytes, std::size_t at, ByteOrder order = ByteOrder::kLittle) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), bytes.data() + at, raw.size());
  const bool native = (order == ByteOrder::kLittle) == (std::endian::native == std::endian::little);
  if (!native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

// kInvalidOption with "name: byte 84: …"; the first byte of a file is byte 0.
inline tl::unexpected<Fault> FailAtByte(const std::string& name, std::size_t at,
                                        std::string_view what) {
  return Fail(FaultKind::kInvalidOption,
              name + ": byte " + std::to_string(at) + ": " + std::string(what));
}

}  // namespace arap
