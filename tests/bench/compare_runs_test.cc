#include "tests/bench/compare_runs.h"

#include <gtest/gtest.h>

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

Json RunOf(double update, double paper, double bytes) {
  return {{"deform",
           {{"10k",
             {{"vertices", 9919},
              {"update_us", update},
              {"paper_update_us", paper},
              {"mesh_bytes", bytes},
              {"paper_distance", 1e-9}}}}}};
}

TEST(CompareRuns, ASlowerMachineIsNoRegression) {
  const Comparison twice = CompareRuns(RunOf(800, 4000, 1e6), RunOf(1600, 8000, 1e6));
  EXPECT_DOUBLE_EQ(twice.machine, 2);
  EXPECT_FALSE(twice.regressed());
  ASSERT_EQ(twice.changes.size(), 2u);
  EXPECT_EQ(twice.changes[0].name, "deform.10k.update_us");
  EXPECT_DOUBLE_EQ(twice.changes[0].factor, 1);
}

TEST(CompareRuns, WhatIsSlowerThanTheMachineIsARegression) {
  const Comparison slower = CompareRuns(RunOf(800, 4000, 1e6), RunOf(1900, 8000, 1e6));
  EXPECT_TRUE(slower.regressed());
  EXPECT_TRUE(slower.changes[0].regression);
  EXPECT_FALSE(slower.changes[1].regression);
}

TEST(CompareRuns, MoreMemoryIsARegressionOnEveryMachine) {
  const Comparison larger = CompareRuns(RunOf(800, 4000, 1e6), RunOf(1600, 8000, 1.2e6));
  EXPECT_TRUE(larger.regressed());
  EXPECT_TRUE(larger.changes[1].regression);
}

TEST(CompareRuns, WithoutOthersTheMachineCountsAsTheSame) {
  const Json before = {{"flatten", {{"10k", {{"total_ms", 20.0}}}}}};
  const Json now = {{"flatten", {{"10k", {{"total_ms", 23.0}}}}}};
  EXPECT_TRUE(CompareRuns(before, now).regressed());
  EXPECT_FALSE(CompareRuns(now, before).regressed());
}

TEST(CompareRuns, AFigureThatIsGoneIsTold) {
  Json now = RunOf(800, 4000, 1e6);
  now["deform"]["10k"].erase("mesh_bytes");
  EXPECT_EQ(CompareRuns(RunOf(800, 4000, 1e6), now).missing,
            std::vector<std::string>{"deform.10k.mesh_bytes"});
}

TEST(CompareRuns, WhatARunLeftOutIsNeitherMissingNorAChange) {
  const Comparison nothing = CompareRuns(RunOf(800, 4000, 1e6), Json::object());
  EXPECT_TRUE(nothing.missing.empty());
  EXPECT_TRUE(nothing.changes.empty());
}

}  // namespace
}  // namespace arap::bench
