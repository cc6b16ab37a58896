// Whether the load generator tells the truth of a server that stalls, to the last message and without
// a clock: what is sent and counted is the generator's own code, the time and the server are made up.
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "client/cli/load/schedule.h"
#include "client/cli/load/tally.h"

namespace arap::cli {
namespace {

constexpr double kRate = 100, kLength = 10;  // messages a second, seconds
constexpr double kService = 0.002, kStallAt = 3, kStall = 1;

// Takes one message after the other, each for kService, and none during the stall.
class StallingServer {
 public:
  // When a message that comes now is answered.
  double Answers(double now) {
    double start = std::max(now, free_);
    if (start + kService > kStallAt && start < kStallAt + kStall) start = kStallAt + kStall;
    return free_ = start + kService;
  }

 private:
  double free_ = 0;
};

// A whole run, one event after the other.
LoadResults Simulate(Sender sender, Moment from = Moment(0),
                     const std::shared_ptr<const RateProfile>& steps = nullptr) {
  std::vector<std::unique_ptr<Tally>> tallies;
  Tally& tally = *tallies.emplace_back(std::make_unique<Tally>(from, steps));
  StallingServer server;
  struct OnItsWay {
    Sent sent;
    Moment answered{0};
  };
  std::deque<OnItsWay> on_their_way;
  for (Moment now{0};;) {
    while (const auto due = sender.Take(now)) {
      const Sent sent{Operation::kDrag, due->intended, now};
      tally.CountSent(sent);
      on_their_way.push_back({sent, FromSeconds(server.Answers(SecondsOf(now)))});
    }
    const Moment answer = on_their_way.empty() ? kNever : on_their_way.front().answered;
    now = std::min(answer, sender.NextDue());
    if (now == kNever) break;
    if (now < answer) continue;
    tally.CountAnswered(on_their_way.front().sent, now, std::nullopt);
    on_their_way.pop_front();
    sender.Answered();
  }
  LoadResults results;
  tally.AddTo(results);
  if (steps) Tally::AddTimes(tallies, FromSeconds(steps->seconds()), results);
  return results;
}

Sender::Options Length(std::size_t window) { return {Moment(0), FromSeconds(kLength), window}; }

Arrivals Constant() {
  return {std::make_shared<const RateProfile>(RateProfile::Constant(kRate, kLength)), {}};
}

// A message that is due t after the stall has begun waits for its end, for the kRate · t before it, and
// for itself: the response is kStall + kService - t · (1 - kRate · kService), until that is kService.
double QuantileByHand(double q) {
  const double slower = (1 - q) * kLength;  // how many seconds of messages take longer
  return std::max(kStall + kService - slower * (1 - kRate * kService), kService);
}

TEST(Honesty, AnOpenLoopHasTheStallInEveryMessageThatItHeldUp) {
  const LoadResults results = Simulate(Sender(Length(kMostOnTheirWay), Constant()));
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_EQ(drags.sent, 1000u);
  EXPECT_EQ(drags.answered, 1000u);
  EXPECT_EQ(drags.late, 0u) << "nothing holds the generator up";
  EXPECT_EQ(drags.unsent, 0u);
  for (const double q : {0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999}) {
    const double micros = 1e6 * QuantileByHand(q);
    EXPECT_NEAR(drags.response.Quantile(q), micros, 0.05 * micros) << q;
  }
  EXPECT_NEAR(drags.response.Max(), 1e6 * (kStall + kService), 1);
}

// As --fps sends: the window is full, so messages wait here and not on the way; their times are the same
// but for where they have waited.
TEST(Honesty, SoHasOneThatWaitsForAnswers) {
  const LoadResults results = Simulate(Sender(Length(1), Constant()));
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_EQ(drags.sent, 1000u);
  for (const double q : {0.5, 0.9, 0.95, 0.99}) {
    const double micros = 1e6 * QuantileByHand(q);
    EXPECT_NEAR(drags.response.Quantile(q), micros, 0.05 * micros) << q;
  }
  EXPECT_NEAR(drags.service.Quantile(0.99), 1e6 * kService, 0.05 * 1e6 * kService);
  // All that were due from the stall on until the backlog was gone, but the one that it hit.
  EXPECT_NEAR(static_cast<double>(drags.late), kRate * kStall / (1 - kRate * kService), 2);
}

TEST(Honesty, AClosedLoopHidesIt) {
  const LoadResults results = Simulate(Sender(Length(1)));
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_NEAR(static_cast<double>(drags.answered), (kLength - kStall) / kService, 2);
  const double service = 1e6 * kService;
  for (const double q : {0.5, 0.9, 0.99, 0.999}) {
    EXPECT_NEAR(drags.response.Quantile(q), service, 0.05 * service) << q;
  }
  EXPECT_NEAR(drags.response.Max(), 1e6 * (kStall + kService), service) << "one message alone";
  EXPECT_EQ(drags.response.Count(), drags.service.Count());
}

TEST(Honesty, WhatWasNotSentByTheEndIsCounted) {
  Sender sender(Length(1), Constant());
  ASSERT_TRUE(sender.Take(Moment(0)));
  EXPECT_EQ(sender.NextDue(), kNever) << "the window is full, and stays so";
  std::uint64_t unsent = 0;
  sender.Close(FromSeconds(20), [&](const Sender::Due& due) {
    EXPECT_EQ(due.number, unsent + 1);
    ++unsent;
  });
  EXPECT_EQ(unsent, 999u);
  EXPECT_FALSE(sender.is_done());
  sender.Answered();
  EXPECT_TRUE(sender.is_done());
}

TEST(Honesty, NothingOfTheWarmUpCounts) {
  const LoadResults results =
      Simulate(Sender(Length(kMostOnTheirWay), Constant()), FromSeconds(kStallAt + 2 * kStall));
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_EQ(drags.sent, 500u);
  EXPECT_NEAR(drags.response.Max(), 1e6 * kService, 1) << "the stall was before";
}

// The stall is in the second of two steps; with a warm-up it is in the first, and what it has held up is answered
// while the second warms up.
TEST(Honesty, AStepHasNothingOfTheOneBeforeIt) {
  for (const double warm_up : {0.0, 2.0}) {
    const auto steps = RateProfile::Parse("step:100,100", 4);
    ASSERT_TRUE(steps);
    const auto profile = std::make_shared<const RateProfile>(steps->WarmedUp(warm_up));
    const Sender::Options options{Moment(0), FromSeconds(profile->seconds()), kMostOnTheirWay};
    const LoadResults results =
        Simulate(Sender(options, Arrivals(profile, {})), Moment(0), profile);
    ASSERT_EQ(results.steps.size(), 2u);
    EXPECT_EQ(results.operations[Operation::kDrag].sent, 400u);
    if (warm_up > 0) {
      EXPECT_GT(results.steps[0].p99, 0.9e6);
      EXPECT_NEAR(results.steps[1].p99, 1e6 * kService, 0.01e6 * kService);
      EXPECT_EQ(results.intervals.size(), 4u) << "of what counts";
    } else {
      EXPECT_NEAR(results.steps[0].p99, 1e6 * kService, 0.01e6 * kService);
      EXPECT_GT(results.steps[1].p99, 0.9e6);
    }
  }
}

TEST(Sender, SendsSoManyAndNotMore) {
  Sender::Options options = Length(3);
  options.most = 5;
  Sender sender(options);
  EXPECT_EQ(sender.Take(Moment(1))->number, 0u);
  EXPECT_EQ(sender.Take(Moment(1))->number, 1u);
  EXPECT_EQ(sender.Take(Moment(1))->number, 2u);
  EXPECT_FALSE(sender.Take(Moment(1))) << "the window";
  for (int i = 0; i < 3; ++i) sender.Answered();
  EXPECT_EQ(sender.Take(Moment(2))->intended, Moment(2));
  EXPECT_TRUE(sender.Take(Moment(2)));
  EXPECT_FALSE(sender.Take(Moment(2))) << "the number";
  EXPECT_EQ(sender.NextDue(), kNever);
}

}  // namespace
}  // namespace arap::cli
