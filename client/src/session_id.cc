#include "client/src/session_id.h"

#include <array>
#include <cstdint>
#include <random>

namespace arap::client::internal {

std::string NewSessionId() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string id;
  for (int word = 0; word < 4; ++word) {
    std::uint32_t bits = random();
    for (int digit = 0; digit < 8; ++digit, bits >>= 4) id.push_back(kDigits[bits & 15]);
  }
  return id;
}

}  // namespace arap::client::internal
