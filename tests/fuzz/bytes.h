// Bytes: an input of the fuzzer taken apart, from the front. At the end everything is zero.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace arap::fuzz {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }

  std::uint8_t Byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }
  bool Coin() { return (Byte() & 1u) != 0; }
  // 0…bound−1, bound at most 256.
  std::uint32_t Below(std::uint32_t bound) { return bound == 0 ? 0 : Byte() % bound; }

  // A number of any kind: mostly small ones that meet each other, sometimes any eight bytes.
  double Number() {
    const std::uint8_t kind = Byte();
    if (kind < 0xC0) return (static_cast<int>(kind) - 0x60) / 16.0;
    switch (kind & 7u) {
      case 0:
        return 1e300 * Byte();
      case 1:
        return 1e-300 * Byte();
      case 2:
        return 1e9 * (Byte() - 128);
      case 3:
        return 1e-9 * (Byte() - 128);
      default:
        break;
    }
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8u | Byte();
    return std::bit_cast<double>(bits);
  }

  // The next part of a sequence: two bytes that say how long it is, and then so many at most.
  std::span<const std::uint8_t> Part() {
    // One after the other: what is left counts after both were taken.
    const std::size_t low = Byte();
    const std::size_t high = Byte();
    const std::size_t length = std::min(low | high << 8u, rest_.size());
    const auto part = rest_.first(length);
    rest_ = rest_.subspan(length);
    return part;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace arap::fuzz
