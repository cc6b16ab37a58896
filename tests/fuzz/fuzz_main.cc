// What libFuzzer calls. ARAP_FUZZ_TARGET is a function of targets.h.
#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  arap::fuzz::ARAP_FUZZ_TARGET(data, size);
  return 0;
}
