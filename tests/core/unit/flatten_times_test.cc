#include <gtest/gtest.h>

#include "arap/core/flattener.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

FlattenOptions Refined() {
  FlattenOptions options;
  options.refine = 3;
  return options;
}

TEST(FlattenTimes, EveryPhaseOfAWholeRunTakesTime) {
  const auto flat = Flatten(SphereCap(12, 24, 1.2), Refined());
  ASSERT_TRUE(flat);
  EXPECT_GT(flat->times.topology, 0);
  EXPECT_GT(flat->times.order, 0);
  EXPECT_GT(flat->times.factor, 0);
  EXPECT_GT(flat->times.solve, 0);
  EXPECT_DOUBLE_EQ(flat->times.total(), flat->times.topology + flat->times.order +
                                            flat->times.factor + flat->times.solve);
}

TEST(FlattenTimes, WhatIsKeptCostsNothing) {
  const auto surface = Prepare(SphereCap(12, 24, 1.2), {});
  ASSERT_TRUE(surface);
  const auto first = Flatten(**surface, Refined());
  const auto second = Flatten(**surface, Refined());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->times.topology, 0);
  EXPECT_GT(first->times.order, 0);
  EXPECT_GT(first->times.factor, 0);
  EXPECT_EQ(second->times.order, 0);
  EXPECT_EQ(second->times.factor, 0);
  EXPECT_GT(second->times.solve, 0);
  EXPECT_EQ(first->uv, second->uv);
}

}  // namespace
}  // namespace arap::testing
