// Bytes of files: unpacked where gzip has made them smaller (.gz), and taken apart number by
// number.
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

bool IsGzip(std::string_view bytes);

// A few bytes may stand for a thousand times as many.
inline constexpr std::size_t kMostUnpacked = std::size_t{256} << 20U;

// The bytes as they were before, of one part or of several one after the other. `name` is what
// messages call the file. How many they are is found out before any of them is kept, so that what is
// refused takes no memory, and what is not takes its size.
//
// kInvalidOption for more than `most` bytes, and with the byte for damaged data (their check sum is
// looked at), a file that ends early or goes on with something else.
Result<std::string> Unpack(std::string_view bytes, const std::string& name,
                           std::size_t most = kMostUnpacked);

}  // namespace arap
