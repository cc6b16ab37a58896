// What is asked of runs of load, and of the difference of two.
#include <cstdint>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

#include "client/cli/load/compare.h"
#include "client/cli/load/outputs.h"
#include "client/cli/load/threshold.h"
#include "client/cli/terminal.h"
#include "tests/cli/made_results.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

std::vector<Judgement> JudgedBy(const LoadResults& results, const std::string& text) {
  const Result<Threshold> threshold = ParseThreshold(text);
  EXPECT_TRUE(threshold) << text << ": " << threshold.error().message;
  if (!threshold) return {};
  return Judge(std::vector{*threshold}, results);
}

TEST(Threshold, IsMetOrMissed) {
  const LoadResults results = FullResults();
  const std::vector<std::pair<const char*, bool>> cases{
      {"p99<1.2ms", true},
      {"p99 < 1100 us", false},
      {"p50<=1100µs", true},
      {"max<0.0012s", true},
      {"drag.p99.9<1200us", true},
      {"edit.response.p50>1ms", true},
      {"drag.queue.p99<100us", false},
      {"drag.solve.mean<=220us", true},
      {"rate>=200", true},
      {"rate>200/s", false},
      {"drag.rate>99", true},
      {"errors<=12", true},
      {"errors<12", false},
      {"errors<1.1%", true},
      {"errors<0.9%", false},
      {"drag.errors<2%", true},
      {"edit.errors<1", true},
      {"late<1%", true},
      {"late<5", false},
      {"unsent<=5", true},
      {"replaced<0.5%", true},
      {"wrong<2%", true},
      {"wrong<1", false},
      {"lost<=4", true},
  };
  for (const auto& [text, met] : cases) {
    const std::vector<Judgement> judged = JudgedBy(results, text);
    ASSERT_EQ(judged.size(), 1u);
    EXPECT_EQ(judged[0].met, met) << text << ", measured " << judged[0].shown;
  }
}

TEST(Threshold, IsMissedWhereNothingWasMeasured) {
  for (const char* const text : {"bake.p99<1s", "p99<1s", "errors<1%", "wrong<1%"}) {
    const std::vector<Judgement> judged = JudgedBy(LoadResults(), text);
    ASSERT_EQ(judged.size(), 1u);
    EXPECT_FALSE(judged[0].met) << text;
    EXPECT_EQ(judged[0].shown, "nothing to measure");
  }
}

TEST(Threshold, SaysWhatIsWrongWithIt) {
  const std::vector<std::pair<const char*, const char*>> cases{
      {"", "none of < <= > >="},
      {"p99", "none of < <= > >="},
      {"p99=20ms", "none of < <= > >="},
      {"p99<20", "a time has the unit us, ms or s"},
      {"p99<20h", "a time has the unit us, ms or s"},
      {"p99<ms", "'ms' does not begin with a number"},
      {"p99<", "'' does not begin with a number"},
      {"p99<-1ms", "below 0"},
      {"p99<nanms", "does not begin with a number"},
      {"p99<infms", "does not begin with a number"},
      {"p99<20ms20ms", "a time has the unit"},
      {"p101<1ms", "'p101' is no figure"},
      {"p<1ms", "'p' is no figure"},
      {"p1e1<1ms", "is no figure"},
      {"median<1ms", "'median' is no figure"},
      {"dance.p99<1ms", "'dance.p99' is no figure"},
      {"drag.errors.p99<1ms", "is no figure"},
      {"queue.errors<1", "errors is a count and no time"},
      {"drag.lost<1", "lost is of all operations"},
      {"rate>10ms", "a rate is a number a second"},
      {"rate>10%", "a rate is a number a second"},
      {"errors<1ms", "a count has no unit"},
      {"errors<101%", "above 100 %"},
      {"p99<<20ms", "does not begin with a number"},
  };
  for (const auto& [text, expected] : cases) {
    const Result<Threshold> threshold = ParseThreshold(text);
    ASSERT_FALSE(threshold) << text;
    EXPECT_THAT(threshold.error().message, HasSubstr(expected)) << text;
  }
}

TEST(Metric, HasANameThatIsReadAgain) {
  for (const char* const name : {"p50", "p99.9", "p99.99", "mean", "max", "rate", "errors", "late",
                                 "unsent", "replaced", "wrong", "lost", "resumed", "found",
                                 "drag.p99", "queue.p50", "flatten.solve.max", "register.errors"}) {
    const Result<Metric> metric = ParseMetric(name);
    ASSERT_TRUE(metric) << name;
    EXPECT_EQ(NameOf(*metric), name);
  }
  EXPECT_EQ(NameOf(*ParseMetric("drag.response.p99")), "drag.p99");
}

TEST(Metric, FiguresHaveThreeDigits) {
  const std::vector<std::pair<double, const char*>> cases{
      {0, "0.00 µs"},      {9.996, "10.0 µs"}, {99.96, "100 µs"},
      {999.4, "999 µs"},   {999.6, "1.00 ms"}, {12'345, "12.3 ms"},
      {999'600, "1.00 s"}, {75e6, "75.0 s"},   {3600e6, "3600 s"},
  };
  for (const auto& [micros, text] : cases) EXPECT_EQ(FormatMicros(micros), text);
  EXPECT_EQ(FormatFigure(0, Unit::kShare), "0.00 %");
  EXPECT_EQ(FormatFigure(1e-7, Unit::kShare), "<0.01 %");
}

TEST(VerdictOf, ARun) {
  const LoadResults good = MadeResults();
  EXPECT_EQ(VerdictOf(good, {}), Exit::kOk);
  EXPECT_EQ(VerdictOf(good, JudgedBy(good, "p99<1us")), Exit::kMissed);
  EXPECT_EQ(VerdictOf(LoadResults(), {}), Exit::kFailed) << "nothing was answered";
  LoadResults some = MadeResults();
  some.errors = {{"", "BAD_REPLY", 1, "x"}};
  EXPECT_EQ(VerdictOf(some, {}), Exit::kFailed);
  EXPECT_EQ(VerdictOf(some, JudgedBy(some, "p99<1s")), Exit::kFailed);
  EXPECT_EQ(VerdictOf(some, JudgedBy(some, "errors<1%")), Exit::kOk) << "some are let pass";
  EXPECT_EQ(VerdictOf(some, JudgedBy(some, "errors<1")), Exit::kMissed);
  LoadResults wrong = MadeResults();
  wrong.operations[Operation::kDrag].verified = 100;
  wrong.operations[Operation::kDrag].wrong = 1;
  EXPECT_EQ(VerdictOf(wrong, {}), Exit::kFailed);
  EXPECT_EQ(VerdictOf(wrong, JudgedBy(wrong, "wrong<=1%")), Exit::kOk);
}

std::optional<LoadDifference> DifferenceOf(const LoadResults& a, const LoadResults& b,
                                           const std::string& name) {
  for (const LoadDifference& one : Compare(a, b)) {
    if (NameOf(one.metric) == name) return one;
  }
  return std::nullopt;
}

TEST(Compare, TellsAChangeFromNoise) {
  // Seconds differ by up to a tenth; a run that is a fifth slower stands out, one of a hundredth not.
  const auto run = [](double micros) {
    return MadeResults(20,
                       [micros](int second) { return micros * (1 + (second * 7 % 5) * 0.025); });
  };
  const auto slower = DifferenceOf(run(1000), run(1200), "drag.p50");
  ASSERT_TRUE(slower && slower->change && slower->noise);
  EXPECT_NEAR(*slower->change, 0.2, 0.03);
  EXPECT_TRUE(slower->BeyondNoise());
  EXPECT_TRUE(slower->Worse());
  EXPECT_FALSE(DifferenceOf(run(1200), run(1000), "drag.p50")->Worse());
  const auto same = DifferenceOf(run(1000), run(1010), "drag.p99");
  ASSERT_TRUE(same && same->noise);
  EXPECT_FALSE(same->BeyondNoise());
}

TEST(Compare, ASecondThatStallsIsNoiseOfTheP99AndNotOfTheMedian) {
  const auto run = [](int stall) {
    return MadeResults(30, [stall](int second) { return second == stall ? 1e6 : 1000; });
  };
  const auto p99 = DifferenceOf(run(-1), run(7), "drag.p99");
  ASSERT_TRUE(p99 && p99->noise);
  EXPECT_GT(*p99->change, 100);
  EXPECT_LT(*DifferenceOf(run(3), run(7), "drag.p50")->noise, 0.02);
  EXPECT_FALSE(DifferenceOf(run(3), run(7), "drag.p99")->BeyondNoise());
}

// 100 drags a second, of which so many of second k are late, and as many due ones were not sent and replaced.
LoadResults WithTroubles(const std::function<std::uint64_t(std::size_t second)>& late) {
  LoadResults results = MadeResults(20);
  OperationResults& drag = results.operations[Operation::kDrag];
  for (std::size_t i = 0; i < results.intervals.size(); ++i) {
    IntervalOperation& part = results.intervals[i].operations[Operation::kDrag];
    part.late = part.unsent = part.replaced = late(i);
    part.offered += part.unsent;
    drag.late += part.late;
    drag.unsent += part.unsent;
    drag.replaced += part.replaced;
  }
  return results;
}

TEST(Compare, JudgesEveryFigureThatHasABetterDirection) {
  const auto run = [](double micros) {
    return MadeResults(20,
                       [micros](int second) { return micros * (1 + (second * 7 % 5) * 0.005); });
  };
  for (const char* const name :
       {"drag.p50", "drag.p90", "drag.p99", "drag.p99.9", "drag.max", "drag.mean",
        "drag.service.p50", "drag.service.p99", "drag.solve.p99"}) {
    const auto worse = DifferenceOf(run(1000), run(1300), name);
    const auto same = DifferenceOf(run(1000), run(1002), name);
    ASSERT_TRUE(worse && worse->noise && same && same->noise) << name;
    EXPECT_TRUE(worse->BeyondNoise() && worse->Worse()) << name << ": noise " << *worse->noise;
    EXPECT_FALSE(same->BeyondNoise())
        << name << ": " << *same->change << ", noise " << *same->noise;
    EXPECT_FALSE(DifferenceOf(run(1300), run(1000), name)->Worse()) << name;
  }
  const LoadResults good = WithTroubles([](std::size_t) { return 0; });
  const LoadResults bad = WithTroubles([](std::size_t second) { return 3 + second % 2; });
  const LoadResults once = WithTroubles([](std::size_t second) { return second == 7 ? 60 : 0; });
  for (const char* const name : {"drag.late", "drag.unsent", "drag.replaced"}) {
    const auto worse = DifferenceOf(good, bad, name);
    ASSERT_TRUE(worse && worse->noise) << name;
    EXPECT_TRUE(worse->BeyondNoise() && worse->Worse()) << name;
    EXPECT_FALSE(DifferenceOf(good, once, name)->BeyondNoise()) << name << ": one bad second";
  }
  // The last answer of a run comes a little sooner or later.
  LoadResults sooner = good;
  sooner.seconds *= 0.999;
  EXPECT_FALSE(DifferenceOf(good, sooner, "drag.rate")->BeyondNoise());
  sooner.seconds *= 0.95;
  EXPECT_FALSE(DifferenceOf(good, sooner, "drag.rate")->Worse());
  // A document of before intervals had them says nothing of their noise.
  LoadResults older = bad;
  for (Interval& interval : older.intervals) interval.operations[Operation::kDrag].late = 0;
  EXPECT_FALSE(DifferenceOf(good, older, "drag.late")->noise);
}

// One value in a thousand, of which there are 600.
TEST(Compare, AFewSlowAnswersAreNoChange) {
  const auto run = [](double slowest) {
    return MadeResults(6, [slowest](int second) { return second == 3 ? slowest : 1000; });
  };
  const auto p999 = DifferenceOf(run(3000), run(6000), "drag.p99.9");
  ASSERT_TRUE(p999 && p999->noise);
  EXPECT_FALSE(p999->BeyondNoise()) << *p999->change << ", noise " << *p999->noise;
}

TEST(Compare, JudgesTheRunAsAWhole) {
  LoadResults a = MadeResults(6), b = a;
  a.operations[Operation::kDrag].verified = b.operations[Operation::kDrag].verified = 500;
  b.operations[Operation::kDrag].wrong = 20;
  b.streams = a.streams = 10;
  b.resumptions = 12;
  b.frames_lost = 15;
  b.errors = {{"UNAVAILABLE", "DRAINING", 30, "x"}};
  for (const char* const name : {"drag.wrong", "resumed", "lost", "errors"}) {
    const auto worse = DifferenceOf(a, b, name);
    ASSERT_TRUE(worse && worse->noise) << name;
    EXPECT_TRUE(worse->BeyondNoise() && worse->Worse()) << name;
    EXPECT_FALSE(DifferenceOf(a, a, name)->BeyondNoise()) << name;
  }
  b.resumptions = 3;
  EXPECT_FALSE(DifferenceOf(a, b, "resumed")->BeyondNoise()) << "so few may come by chance";
  // The rate that was found, to the resolution of the search.
  a.steps = {{100, 100, 1, 1, 1, true}, {105, 100, 1, 1, 1, false}, {200, 120, 1, 1, 1, false}};
  a.rate_found = 100;
  b.steps = a.steps;
  b.rate_found = 80;
  b.steps[0].rate = 80;
  b.steps[1].rate = 84;
  const auto found = DifferenceOf(a, b, "found");
  ASSERT_TRUE(found && found->noise);
  EXPECT_NEAR(*found->noise, 0.1, 1e-9);
  EXPECT_TRUE(found->BeyondNoise() && found->Worse());
}

TEST(Compare, OfShortRunsSaysNothingOfNoise) {
  const auto one = DifferenceOf(MadeResults(4, 1000.0), MadeResults(20, 2000.0), "drag.p50");
  ASSERT_TRUE(one && one->change);
  EXPECT_FALSE(one->noise);
  EXPECT_FALSE(one->BeyondNoise());
}

TEST(Compare, TellsWhatOneRunAloneHas) {
  LoadResults drags = MadeResults();
  drags.operations[Operation::kEdit] = {};
  drags.settings["--mix"] = "drag=1";
  drags.settings["--json"] = "a.json";
  const LoadResults both = MadeResults();
  const auto edits = DifferenceOf(drags, both, "edit.p50");
  ASSERT_TRUE(edits);
  EXPECT_FALSE(edits->a);
  EXPECT_TRUE(edits->b);
  EXPECT_FALSE(edits->change);
  const std::string text = CompareText({"a.json", drags}, {"b.json", both}, {}, STDIN_FILENO);
  EXPECT_THAT(text, HasSubstr("--mix"));
  EXPECT_THAT(text, testing::Not(HasSubstr("--rate"))) << "the same in both";
  EXPECT_THAT(text, testing::Not(HasSubstr("--json"))) << "where it went is no setting of the run";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(CharactersIn(line), 80u) << line;
  const auto json = CompareJson({"a.json", drags}, {"b.json", both}, {});
  EXPECT_EQ(json["different_settings"]["--mix"][0], "drag=1");
  EXPECT_TRUE(json["figures"].is_array());
}

TEST(Compare, ThresholdsAreOfTheDifference) {
  LoadResults b = MadeResults(6, 1100.0);
  b.operations[Operation::kDrag].failed = 6;
  const LoadResults a = MadeResults(6, 1000.0);
  const std::vector<std::pair<const char*, bool>> cases{
      {"p99<5%", false},     {"p99<+15%", true},     {"p50>-1%", true},    {"rate>-2%", true},
      {"rate>0%", false},    {"unsent<=0%", true},   {"resumed<1%", true}, {"errors<0.1%", false},
      {"errors<0.6%", true}, {"bake.p50<9%", false},
  };
  for (const auto& [text, met] : cases) {
    const Result<Threshold> threshold = ParseDifferenceThreshold(text);
    ASSERT_TRUE(threshold) << text;
    const auto judged = JudgeDifference(std::vector{*threshold}, a, b);
    EXPECT_EQ(judged.at(0).met, met) << text << ": " << judged[0].shown;
  }
  // A rate is compared with itself, however large it is.
  LoadResults fewer = a;
  fewer.operations[Operation::kDrag].answered -= 6;
  for (const auto& [text, met] : {std::pair("rate>-2%", true), std::pair("rate>-0.1%", false)}) {
    const auto judged = JudgeDifference(std::vector{*ParseDifferenceThreshold(text)}, a, fewer);
    EXPECT_EQ(judged.at(0).met, met) << text << ": " << judged[0].shown;
  }
  EXPECT_FALSE(ParseDifferenceThreshold("p99<5ms"));
  EXPECT_FALSE(ParseDifferenceThreshold("p99<5"));
}

}  // namespace
}  // namespace arap::cli
