// How much memory a server may take beyond what it began with, in tests.
#pragma once

#include <cstddef>

namespace arap::fault {

// A sanitizer's shadow and its quarantine come on top.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr std::size_t kMemoryFactor = 4;
#else
inline constexpr std::size_t kMemoryFactor = 1;
#endif

constexpr std::size_t Megabytes(std::size_t count) { return (count * kMemoryFactor) << 20; }

}  // namespace arap::fault
