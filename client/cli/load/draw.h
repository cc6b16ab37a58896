// Numbers that look random and depend on nothing but what is asked: the same on every machine and in
// every order, so that two runs with one seed send the same things at the same times.
#pragma once

#include <cstdint>

namespace arap::cli {

// What is drawn for: numbers for different purposes have nothing to do with each other.
enum class Draw : std::uint64_t { kArrival = 1, kOperation = 2, kMotion = 3, kVerify = 4 };

// 64 bits for the `number`-th of a stream.
constexpr std::uint64_t DrawBits(std::uint64_t seed, Draw what, std::uint64_t stream,
                                 std::uint64_t number) {
  // A bijection whose every output bit depends on every input bit.
  const auto mix = [](std::uint64_t x) {
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93;
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93;
    return x ^ (x >> 32);
  };
  std::uint64_t bits = mix(seed + 0x9e3779b97f4a7c15);
  bits = mix(bits ^ (static_cast<std::uint64_t>(what) * 0xa0761d6478bd642f));
  bits = mix(bits + stream * 0xe7037ed1a0b428db);
  return mix(bits + number * 0x8ebc6af09c88c6e3);
}

// From 0 to 1, 1 left out.
constexpr double DrawPart(std::uint64_t seed, Draw what, std::uint64_t stream,
                          std::uint64_t number) {
  constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return static_cast<double>(DrawBits(seed, what, stream, number) >> 11) * kUnit;
}

}  // namespace arap::cli
