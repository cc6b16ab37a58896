// Random numbers for tests of the sparse room.
#pragma once

#include <random>
#include <type_traits>

namespace arap::testing {

// A real number in [−1, 1), or a complex one of two such.
template <class Scalar>
Scalar Number(std::mt19937_64& random) {
  const auto unit = [&] { return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1; };
  if constexpr (std::is_same_v<Scalar, double>) {
    return unit();
  } else {
    const double re = unit(), im = unit();
    return {re, im};
  }
}

}  // namespace arap::testing
