#include "tests/fuzz/memory_cap.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "tests/fuzz/check.h"

// Only clang brings the header.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) && __has_include(<sanitizer/allocator_interface.h>)
#include <sanitizer/allocator_interface.h>
#define ARAP_COUNTS_MEMORY
#endif
#endif

namespace arap::fuzz {
namespace {

struct Counted {
  bool on = false;
  // What was there before may be given back.
  std::int64_t bytes = 0, peak = 0;
};
thread_local Counted counted;

#ifdef ARAP_COUNTS_MEMORY
void CountAllocation(const volatile void* /*block*/, std::size_t size) {
  if (!counted.on) return;
  counted.bytes += static_cast<std::int64_t>(size);
  counted.peak = std::max(counted.peak, counted.bytes);
}

void CountRelease(const volatile void* block) {
  if (!counted.on) return;
  counted.bytes -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(block));
}
#endif

}  // namespace

MemoryCap::MemoryCap(std::size_t input) : most_((std::size_t{64} << 20U) + 20 * input) {
#ifdef ARAP_COUNTS_MEMORY
  static const int kHooked =
      __sanitizer_install_malloc_and_free_hooks(&CountAllocation, &CountRelease);
  Promise(kHooked != 0, "allocations can be counted");
#endif
  counted = {.on = true};
}

MemoryCap::~MemoryCap() {
  counted.on = false;
  Promise(counted.peak <= static_cast<std::int64_t>(most_),
          "a reader takes the memory of its input", std::to_string(counted.peak).c_str());
}

}  // namespace arap::fuzz
