#include "server/runtime/time_slice.h"

#include <cstdint>

#include <sys/syscall.h>
#include <unistd.h>

namespace arap::runtime {
namespace {

// The kernel's struct sched_attr in its first version; Debian's headers of the C library have none.
struct Attributes {
  std::uint32_t size = sizeof(Attributes);
  std::uint32_t policy = 0;
  std::uint64_t flags = 0;
  std::int32_t nice = 0;
  std::uint32_t priority = 0;
  std::uint64_t runtime = 0;  // nanoseconds
  std::uint64_t deadline = 0;
  std::uint64_t period = 0;
};
constexpr std::uint32_t kOrdinary = 0;  // SCHED_OTHER: what the others mean by runtime is not this

}  // namespace

void SetTimeSlice(std::chrono::microseconds slice) {
  Attributes attributes;
  if (syscall(SYS_sched_getattr, 0, &attributes, sizeof attributes, 0) != 0) return;
  if (attributes.policy != kOrdinary) return;
  attributes.runtime = static_cast<std::uint64_t>(std::chrono::nanoseconds(slice).count());
  syscall(SYS_sched_setattr, 0, &attributes, 0);
}

}  // namespace arap::runtime
