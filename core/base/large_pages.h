// Arrays that are written once from end to end: the system gives them in pages of 2 MiB, where it can.
#pragma once

#include <cstddef>
#include <cstdint>

#include <sys/mman.h>

namespace arap {

// Of `bytes` at `data`, which nobody has written to yet. Getting 10 MB in pages of 4 KiB takes 3 ms, as much as factoring
// them, and 40 MB takes 15; in large ones a tenth. Only whole large pages inside the array: no memory is taken beside it.
// Not of arrays of more than 64 MiB: a virtual machine whose host takes back what is free asks for every large page anew,
// 0.4 s for 360 MB.
inline void PreferLargePages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20u;
  constexpr std::size_t kMost = 32 * kPage;
  if (bytes > kMost) return;
  const auto begin = (reinterpret_cast<std::uintptr_t>(data) + kPage - 1) / kPage * kPage;
  const std::uintptr_t end = (reinterpret_cast<std::uintptr_t>(data) + bytes) / kPage * kPage;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

}  // namespace arap
