// The memory that a reader of files may take.
#pragma once

#include <cstddef>

namespace arap::fuzz {

// Counts what its thread allocates while it lives, and promises in the end that it was at no time more
// than 64 MiB and 20 bytes for each of the input. Only clang's AddressSanitizer tells, as script/fuzz
// has it; without it nothing is counted. One at a time in a thread.
class MemoryCap {
 public:
  explicit MemoryCap(std::size_t input);
  ~MemoryCap();
  MemoryCap(const MemoryCap&) = delete;
  MemoryCap& operator=(const MemoryCap&) = delete;

 private:
  std::size_t most_;
};

// What `read` answers, which takes no more than an input of that size may.
template <class Read>
auto Capped(std::size_t input, const Read& read) {
  const MemoryCap cap(input);
  return read();
}

}  // namespace arap::fuzz
