// Waits that end: at Ctrl-C, and when nothing comes.
#include "client/cli/patience.h"

#include <csignal>
#include <future>

#include <gtest/gtest.h>

namespace arap::cli {
namespace {

constexpr std::chrono::seconds kBound{30};
constexpr std::chrono::hours kLong{1};

const Fault kCut(FaultKind::kCancelled, "The call was cancelled.");

TEST(Patience, IsLostAfterTheLimitAndSaysSo) {
  std::promise<void> given_up;
  const Patience patience(std::chrono::milliseconds(1), [&] { given_up.set_value(); });
  ASSERT_EQ(given_up.get_future().wait_for(kBound), std::future_status::ready)
      << "silence did not end the wait";
  const Fault fault = patience.Explain(kCut);
  EXPECT_EQ(fault.kind, FaultKind::kDeadlineExceeded);
  EXPECT_EQ(fault.message,
            "The server has sent nothing new for 0.001 s; --timeout is how long to wait.");
}

TEST(Patience, EndsAtCtrlC) {
  std::promise<void> given_up;
  {
    const Patience patience(kLong, [&] { given_up.set_value(); });
    std::raise(SIGINT);
    ASSERT_EQ(given_up.get_future().wait_for(kBound), std::future_status::ready)
        << "SIGINT did not end the wait";
    EXPECT_EQ(patience.Explain(kCut), Fault(FaultKind::kCancelled, "Interrupted."));
  }
  struct sigaction now {};
  sigaction(SIGINT, nullptr, &now);
  EXPECT_EQ(now.sa_handler, SIG_DFL);
}

TEST(Patience, LeavesOtherFaultsAlone) {
  bool given_up = false;
  {
    Patience patience(kLong, [&] { given_up = true; });
    patience.Heard();
    EXPECT_EQ(patience.Explain(kCut), kCut);
  }
  EXPECT_FALSE(given_up);
}

}  // namespace
}  // namespace arap::cli
