// Random: seeded numbers that are the same on every platform. The standard fixes the engine's
// output but not that of its distributions, so the mapping to intervals is our own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace arap::testing {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  // Uniform in [low, high).
  double Uniform(double low, double high) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return low + (high - low) * unit;
  }

  // Uniform in 0…bound−1; the bias of the remainder is far below what a test can notice.
  std::size_t Below(std::size_t bound) { return static_cast<std::size_t>(engine_() % bound); }

  bool Coin() { return (engine_() >> 63) != 0; }

  template <class T>
  void Shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[Below(i)]);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace arap::testing
