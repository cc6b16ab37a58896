#include "server/runtime/time_slice.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace arap::runtime {
namespace {

using std::chrono::microseconds;

// The policy, the niceness and the slice of this thread: nanoseconds, 0 where the kernel tells none.
struct Turns {
  std::uint32_t policy = 0;
  std::int32_t nice = 0;
  std::uint64_t nanoseconds = 0;
  bool operator==(const Turns&) const = default;
};

Turns Mine() {
  std::uint32_t words[12] = {sizeof words};
  EXPECT_EQ(syscall(SYS_sched_getattr, 0, words, sizeof words, 0), 0);
  return {words[1], static_cast<std::int32_t>(words[4]), words[6] | std::uint64_t{words[7]} << 32u};
}

void InThread(const std::function<void()>& work) { std::thread(work).join(); }

TEST(TimeSliceTest, ChangesNeitherPolicyNorNiceness) {
  InThread([] {
    const Turns before = Mine();
    SetTimeSlice(kQuickTurns);
    const Turns after = Mine();
    EXPECT_EQ(after.policy, before.policy);
    EXPECT_EQ(after.nice, before.nice);
    InThread([&] { EXPECT_EQ(Mine(), after) << "threads inherit it"; });
    SetTimeSlice(microseconds(0));
    EXPECT_EQ(Mine(), before);
  });
}

TEST(TimeSliceTest, IsWhatTheKernelGivesWhereItKnowsSlices) {
  InThread([] {
    const std::uint64_t own = Mine().nanoseconds;
    SetTimeSlice(kLongTurns);
    const std::uint64_t asked = Mine().nanoseconds;
    if (own == 0) GTEST_SKIP() << "This kernel has no slices.";
    EXPECT_EQ(microseconds(asked / 1'000), kLongTurns);
  });
}

}  // namespace
}  // namespace arap::runtime
