// What is left to chance, and yet the same in every run of one seed: numbers that look random, and
// what the streams are busy with.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "arap/base/result.h"
#include "client/cli/load/results.h"

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

// Drags and edits are messages of the stream; baking, flattening and registering are calls of its
// session beside it.
class Mix {
 public:
  // Drags alone.
  Mix() { weights_[Operation::kDrag] = 1; }
  // "drag=90,edit=5,bake=2,flatten=2,register=1": weights, of which only the ratios count; what is not
  // named does not happen. kInvalidOption, with the field "mix", for anything else.
  static Result<Mix> Parse(std::string_view text);

  // What the `number`-th message of a stream is, by the seed alone.
  Operation At(std::uint64_t seed, std::size_t stream, std::uint64_t number) const;
  bool Has(Operation operation) const { return weights_[operation] > 0; }

 private:
  PerOperation<double> weights_;
};

}  // namespace arap::cli
