#include "core/outline/coverage.h"

#include <gtest/gtest.h>

#include "tests/core/outline/drawn.h"

namespace arap {
namespace {

using testing::CountInside;
using testing::Noise;
using testing::Rows;

TEST(Borders, EachIsFoundOnceWithThePixelsThatItGoesRound) {
  const Coverage coverage = Rows({"....#", ".###.", ".#.#.", ".###.", "....."});
  Borders borders(coverage);
  // The pixel in the corner touches the ring and belongs to it.
  ASSERT_TRUE(borders.Find());
  EXPECT_EQ(borders.area(), 10);
  ASSERT_TRUE(borders.Find());
  EXPECT_EQ(borders.area(), -1);
  EXPECT_FALSE(borders.Find());
}

TEST(DropSpecks, LeavesOutSmallPiecesAndClosesSmallHoles) {
  Coverage coverage =
      Rows({"#..........", "..#######..", "..#.###.#..", "..#####.#.#", "..#######.#"});
  const Dropped dropped = DropSpecks(3, 2, coverage);
  EXPECT_EQ(dropped.pieces, 2u);
  EXPECT_EQ(dropped.holes, 1u);
  EXPECT_EQ(dropped.largest_piece, 2u);
  EXPECT_EQ(
      coverage.values,
      Rows({"...........", "..#######..", "..#####.#..", "..#####.#..", "..#######.."}).values);
}

TEST(DropSpecks, EveryHoleMayBeClosedWithWhatIsInIt) {
  Coverage coverage =
      Rows({"#######", "#.....#", "#.###.#", "#.#.#.#", "#.###.#", "#.....#", "#######"});
  const Dropped dropped = DropSpecks(0, kEveryHole, coverage);
  EXPECT_EQ(dropped.pieces, 0u);
  EXPECT_EQ(dropped.holes, 2u);
  EXPECT_EQ(CountInside(coverage), 49u);
}

TEST(DropSpecks, NothingIsLeftOfNoise) {
  Coverage coverage = Noise(60, 40, 0.2, 7);
  EXPECT_GT(DropSpecks(2400, 0, coverage).pieces, 100u);
  EXPECT_EQ(CountInside(coverage), 0u);
}

// Against looking at every pair of pixels.
TEST(Expand, TakesWhatIsNearEnough) {
  for (const double distance : {0.4, 1.0, 3.7, 12.0}) {
    for (const double density : {0.002, 0.05}) {
      const Coverage coverage = Noise(41, 33, density, 3);
      const Coverage wide = Expand(coverage, distance);
      ASSERT_EQ(wide.width, coverage.width + 2 * wide.margin);
      ASSERT_GE(static_cast<double>(wide.margin), distance);
      const auto margin = static_cast<std::ptrdiff_t>(wide.margin);
      for (std::ptrdiff_t y = 0; y < static_cast<std::ptrdiff_t>(wide.height); ++y) {
        for (std::ptrdiff_t x = 0; x < static_cast<std::ptrdiff_t>(wide.width); ++x) {
          double nearest = 1e9;
          for (std::ptrdiff_t v = 0; v < 33; ++v) {
            for (std::ptrdiff_t u = 0; u < 41; ++u) {
              if (!coverage.Inside(u, v)) continue;
              nearest = std::min(nearest, std::hypot(static_cast<double>(x - margin - u),
                                                     static_cast<double>(y - margin - v)));
            }
          }
          EXPECT_EQ(wide.Inside(x, y), nearest <= distance + 0.5)
              << x << " " << y << " at " << nearest << " with " << distance;
        }
      }
    }
  }
}

TEST(Expand, OfNothingIsNothing) { EXPECT_EQ(CountInside(Expand(Rows({"...", "..."}), 2)), 0u); }

}  // namespace
}  // namespace arap
