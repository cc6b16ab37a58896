#include "client/cli/load/percentiles.h"

#include <gtest/gtest.h>

namespace arap::cli {
namespace {

TEST(Percentiles, OfOneToAHundred) {
  std::vector<double> samples;
  for (int i = 100; i >= 1; --i) samples.push_back(i);
  const Percentiles percentiles = PercentilesOf(samples);
  EXPECT_EQ(percentiles.p50, 50);
  EXPECT_EQ(percentiles.p90, 90);
  EXPECT_EQ(percentiles.p99, 99);
  EXPECT_EQ(percentiles.max, 100);
}

TEST(Percentiles, OfOneSampleAreThatSample) {
  const Percentiles percentiles = PercentilesOf({7});
  EXPECT_EQ(percentiles.p50, 7);
  EXPECT_EQ(percentiles.p99, 7);
  EXPECT_EQ(percentiles.max, 7);
}

TEST(Percentiles, OfNothingAreZero) { EXPECT_EQ(PercentilesOf({}).max, 0); }

}  // namespace
}  // namespace arap::cli
