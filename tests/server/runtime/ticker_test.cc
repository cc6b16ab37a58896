// The ticker: again and again, and never after Stop.
#include "server/runtime/ticker.h"

#include <atomic>
#include <future>

#include <gtest/gtest.h>

namespace arap::runtime {
namespace {

using std::chrono::milliseconds;

TEST(TickerTest, TicksUntilStopped) {
  std::promise<void> third;
  std::atomic<int> ticks{0};
  Ticker ticker(milliseconds(1), [&] {
    if (++ticks == 3) third.set_value();
  });
  ASSERT_EQ(third.get_future().wait_for(std::chrono::minutes(1)), std::future_status::ready);
  ticker.Stop();
  const int stopped_at = ticks;
  ticker.Stop();
  EXPECT_EQ(ticks, stopped_at);
}

TEST(TickerTest, StopDoesNotWaitForThePeriod) {
  std::atomic<int> ticks{0};
  {
    const Ticker ticker(std::chrono::hours(1), [&] { ++ticks; });
  }
  {
    const Ticker never(milliseconds(0), [&] { ++ticks; });
  }
  EXPECT_EQ(ticks, 0);
}

}  // namespace
}  // namespace arap::runtime
