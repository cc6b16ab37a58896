// What is measured of an attack is judged by the promises: each alone, and all together.
#include "tests/attack/verdict.h"

#include <gmock/gmock.h>

namespace arap::attack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Nothing happened to anybody.
Measured Held() {
  Measured measured;
  measured.name = "none";
  measured.before.frames = std::vector<double>(100, 4);
  measured.unloaded = 4;
  measured.during.frames = std::vector<double>(100, 12);
  measured.during.compiles = {199};
  measured.during.flattens = {299};
  measured.during.looks = 10;
  measured.budget_bytes = 1'000;
  measured.peak_bytes = 1'200;
  measured.drain_seconds = 3;
  measured.stopping = 4.9;
  return measured;
}

TEST(Verdict, WhatIsWithinEveryBoundHeld) {
  EXPECT_THAT(BrokenPromises(Held()), IsEmpty());
  EXPECT_THAT(Row(Held()), HasSubstr("HELD"));
}

TEST(Verdict, EachBrokenPromiseIsNamed) {
  const auto broken = [](const std::function<void(Measured&)>& change) {
    Measured measured = Held();
    change(measured);
    return BrokenPromises(measured);
  };
  EXPECT_THAT(broken([](Measured& m) { m.during.frames.assign(100, 12.5); }),
              ElementsAre("frame 12 ms, allowed 12"));
  EXPECT_THAT(broken([](Measured& m) { m.during.compiles.push_back(201); }),
              ElementsAre("compilation 201 ms"));
  EXPECT_THAT(broken([](Measured& m) { m.during.flattens.push_back(301); }),
              ElementsAre("flattening 301 ms"));
  EXPECT_THAT(broken([](Measured& m) { m.during.failures["open UNAVAILABLE"] = 2; }),
              ElementsAre("2 × open UNAVAILABLE"));
  EXPECT_THAT(broken([](Measured& m) { m.during.surfaces_lost = 1; }),
              ElementsAre("1 kept surfaces lost"));
  EXPECT_THAT(broken([](Measured& m) { m.during.lies = 3; }),
              ElementsAre("/readyz wrong 3 of 10 times"));
  EXPECT_THAT(broken([](Measured& m) { m.peak_bytes = 1'210; }),
              ElementsAre("memory 1.21 of the budget"));
  EXPECT_THAT(broken([](Measured& m) { m.stopping = 5.1; }), ElementsAre("5.1 s to stop"));
  EXPECT_THAT(broken([](Measured& m) { m.stopping.reset(); }), ElementsAre("does not stop"));
  EXPECT_THAT(broken([](Measured& m) { m.ended = "with code 134"; }),
              ElementsAre("the server ended: with code 134"));
  EXPECT_THAT(broken([](Measured& m) { m.during.compiles.clear(); }),
              ElementsAre("nothing was answered"));
}

TEST(Verdict, QuickFramesMayTakeThreeMilliseconds) {
  Measured measured = Held();
  measured.before.frames.assign(100, 0.2);
  measured.during.frames.assign(100, 3);
  EXPECT_THAT(BrokenPromises(measured), IsEmpty());
}

TEST(Verdict, PercentileIsOfTheValuesThemselves) {
  std::vector<double> values;
  for (int i = 1; i <= 200; ++i) values.push_back(i);
  EXPECT_EQ(Percentile99(values), 198);
  EXPECT_EQ(Percentile99({7}), 7);
  EXPECT_EQ(Percentile99({}), 0);
}

}  // namespace
}  // namespace arap::attack
