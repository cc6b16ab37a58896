#include "tests/system/fault/trend.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace arap::fault {
namespace {

TEST(Trend, FitsALine) {
  const std::vector<double> samples{3, 5, 7, 9};
  EXPECT_DOUBLE_EQ(Fit(samples).slope, 2);
  EXPECT_DOUBLE_EQ(Fit(samples).mean, 6);
  EXPECT_DOUBLE_EQ(Rise(samples), 6);
}

TEST(Trend, ALeakShowsInNoise) {
  testing::Random random(1);
  std::vector<double> flat, leaking;
  for (int i = 0; i < 600; ++i) {
    const double noise = random.Uniform(-5, 5);
    flat.push_back(100 + noise);
    leaking.push_back(100 + noise + 0.05 * i);
  }
  EXPECT_LT(Rise(flat), 2);
  EXPECT_GT(Rise(leaking), 25);
}

TEST(Trend, WarmingUpIsNotCounted) {
  std::vector<double> samples{1, 2, 3};
  samples.insert(samples.end(), 6, 4.0);
  EXPECT_EQ(AfterWarmUp(samples).size(), 6u);
  EXPECT_EQ(Rise(AfterWarmUp(samples)), 0);
}

TEST(Trend, OfNothingIsNothing) {
  EXPECT_EQ(Rise({}), 0);
  EXPECT_EQ(Rise(std::vector<double>{7}), 0);
}

}  // namespace
}  // namespace arap::fault
