#include "core/outline/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/plane.h"
#include "core/outline/outline.h"
#include "core/outline/quality_mesh.h"
#include "tests/core/outline/drawn.h"

namespace arap {
namespace {

using testing::AreaOf;
using testing::Box;
using testing::Drawn;

// A figure with arms of random lengths round a point.
Outline Star(Complex middle, std::size_t points, unsigned seed) {
  std::mt19937 random(seed);
  Outline star;
  for (std::size_t i = 0; i < points; ++i) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
    star.push_back(middle +
                   std::polar(2 + 8 * static_cast<double>(random()) / 4294967296.0, angle));
  }
  return star;
}

double AwayFrom(const std::vector<Outline>& outlines, Complex p) {
  double away = std::numeric_limits<double>::infinity();
  for (const Outline& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Complex a = outline[i], along = outline[(i + 1) % outline.size()] - a;
      const double t = std::clamp(Dot(p - a, along) / std::norm(along), 0.0, 1.0);
      away = std::min(away, std::abs(p - a - t * along));
    }
  }
  return away;
}

// By a ray to the right.
bool IsInside(const std::vector<Outline>& outlines, Complex p) {
  bool inside = false;
  for (const Outline& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Complex a = outline[i], b = outline[(i + 1) % outline.size()];
      if ((a.imag() > p.imag()) == (b.imag() > p.imag())) continue;
      const double t = (p.imag() - a.imag()) / (b.imag() - a.imag());
      inside ^= a.real() + t * (b.real() - a.real()) > p.real();
    }
  }
  return inside;
}

TEST(ShapeOutlines, LeavesAloneWhatNothingIsAskedOf) {
  const std::vector<Outline> crossing{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}};
  const auto shaped = ShapeOutlines(crossing, {.vertices = 5});
  ASSERT_TRUE(shaped);
  EXPECT_EQ(shaped->outlines, crossing);
  EXPECT_EQ(shaped->error, 0);
  EXPECT_EQ(EstimateShaping(1000, {}).bytes, 0u);
}

TEST(ShapeOutlines, SimplifiesAsOutlinesOfImagesAre) {
  const auto traced = TraceOutlines(Drawn(200, 200, [](Complex p) {
    const Complex q = p - Complex(100, 100);
    return 60 + 25 * std::cos(5 * std::arg(q)) - std::abs(q);
  }));
  ASSERT_TRUE(traced);
  const auto shaped = ShapeOutlines(*traced, {.tolerance = 1});
  ASSERT_TRUE(shaped);
  EXPECT_EQ(shaped->outlines, *SimplifyOutlines(*traced, 1));
  EXPECT_EQ(shaped->error, 1);
  EXPECT_LT(shaped->outlines[0].size(), (*traced)[0].size() / 5);
}

TEST(ShapeOutlines, ASquareGrowsByItsSidesAndAQuarterOfADiscAtEachCorner) {
  for (const double unit : {1e-9, 1.0, 1e9}) {
    for (const double tolerance : {0.0, 1e-3, 0.1}) {
      const auto shaped = ShapeOutlines(std::vector<Outline>{Box(0, 0, 10 * unit, 10 * unit)},
                                        {.tolerance = tolerance * unit, .expansion = 2 * unit});
      ASSERT_TRUE(shaped) << shaped.error().message;
      EXPECT_LE(shaped->error, std::max(1.01 * tolerance, 0.021) * unit);
      ASSERT_EQ(shaped->outlines.size(), 1u);
      const double expected = 100 + 80 + 4 * std::numbers::pi;
      EXPECT_NEAR(std::abs(AreaOf(shaped->outlines)) / unit / unit, expected,
                  56 * shaped->error / unit);
      // As many lines for the corners as that needs.
      EXPECT_LT(shaped->outlines[0].size(), 120u);
    }
  }
}

TEST(ShapeOutlines, PiecesRunTogetherAndHolesClose) {
  const std::vector<Outline> two{Box(0, 0, 4, 4), Box(6, 0, 10, 4)};
  EXPECT_EQ(ShapeOutlines(two, {.expansion = 0.9})->outlines.size(), 2u);
  EXPECT_EQ(ShapeOutlines(two, {.expansion = 1.1})->outlines.size(), 1u);
  const std::vector<Outline> ring{Box(0, 0, 10, 10), Box(4, 4, 6, 6)};
  EXPECT_EQ(ShapeOutlines(ring, {.expansion = 0.9})->outlines.size(), 2u);
  EXPECT_EQ(ShapeOutlines(ring, {.expansion = 1.1})->outlines.size(), 1u);
  // An island fills what is left of its hole.
  const std::vector<Outline> island{Box(0, 0, 10, 10), Box(2, 2, 8, 8), Box(4, 4, 6, 6)};
  EXPECT_EQ(ShapeOutlines(island, {.expansion = 0.9})->outlines.size(), 3u);
  EXPECT_EQ(ShapeOutlines(island, {.expansion = 1.1})->outlines.size(), 5u);  // in its corners
  EXPECT_EQ(ShapeOutlines(island, {.expansion = 1.3})->outlines.size(), 1u);
}

// Whatever the figure, its border lies where it should, and the mesher takes it.
TEST(ShapeOutlines, EveryPointIsAsFarAsTheExpansionGiveOrTakeTheError) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const std::vector<Outline> given{Star({0, 0}, 20 + 7 * seed, seed),
                                     Star({21, 3}, 31, seed + 99)};
    for (const double expansion : {0.02, 0.5, 4.0}) {
      const double tolerance = seed % 2 == 0 ? 0 : 0.1;
      SCOPED_TRACE(std::to_string(seed) + ", " + std::to_string(expansion));
      const auto shaped = ShapeOutlines(given, {.tolerance = tolerance, .expansion = expansion});
      ASSERT_TRUE(shaped) << shaped.error().message;
      double low = expansion, high = expansion;
      for (const Outline& outline : shaped->outlines) {
        for (std::size_t i = 0; i < outline.size(); ++i) {
          for (const double t : {0.0, 0.5}) {
            const Complex p = outline[i] + t * (outline[(i + 1) % outline.size()] - outline[i]);
            // A simplified border may be on the inner side where it grows by very little.
            const double away = AwayFrom(given, p) * (IsInside(given, p) ? -1 : 1);
            low = std::min(low, away);
            high = std::max(high, away);
          }
        }
      }
      EXPECT_GE(low, expansion - shaped->error);
      EXPECT_LE(high, expansion + shaped->error);
      EXPECT_TRUE(MeshOutlines(shaped->outlines, 200));
    }
  }
}

TEST(ShapeOutlines, WhatTouchesWhenItGrowsGrowsALittleMore) {
  const std::vector<Outline> corners{Box(0, 0, 2, 2), Box(5, 6, 7, 8)};  // 5 from one another
  const auto shaped = ShapeOutlines(corners, {.expansion = 2.5});
  ASSERT_TRUE(shaped) << shaped.error().message;
  EXPECT_TRUE(MeshOutlines(shaped->outlines, 200));
  EXPECT_LT(shaped->error, 0.03);
}

TEST(ShapeOutlines, FarFromZeroItIsTheSame) {
  const std::vector<Outline> near{Star({0, 0}, 40, 1)};
  std::vector<Outline> far = near;
  for (Complex& p : far[0]) p += Complex(500'000, 5'400'000);
  const OutlineOptions options{.tolerance = 0.1, .expansion = 1};
  const auto expected = ShapeOutlines(near, options), shaped = ShapeOutlines(far, options);
  ASSERT_TRUE(expected && shaped);
  EXPECT_NEAR(shaped->error, expected->error, 1e-6);
  for (const Complex p : shaped->outlines[0]) {
    EXPECT_NEAR(AwayFrom(near, p - Complex(500'000, 5'400'000)), 1, shaped->error + 1e-8);
  }
}

TEST(ShapeOutlines, WhatIsWrongIsRefusedBeforeTheWork) {
  const std::vector<Outline> box{Box(0, 0, 3, 4)};
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double wrong : {-1e-9, kInfinite, std::nan("")}) {
    EXPECT_EQ(ShapeOutlines(box, {.tolerance = wrong}).error().field, "tolerance");
    EXPECT_EQ(ShapeOutlines(box, {.expansion = wrong}).error().field, "expansion");
  }
  EXPECT_TRUE(ShapeOutlines(box, {.expansion = 5}));
  const auto large = ShapeOutlines(box, {.expansion = 5.001});
  ASSERT_FALSE(large);
  EXPECT_EQ(DetailOf(large.error(), "limit"), "5");

  const std::vector<Outline> crossing{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}};
  const std::vector<Outline> touching{Box(0, 0, 1, 1), Box(1, 1, 2, 2)};
  for (const auto& outlines : {crossing, touching}) {
    for (const OutlineOptions& options :
         {OutlineOptions{.tolerance = 0.1}, OutlineOptions{.expansion = 0.1}}) {
      const auto shaped = ShapeOutlines(outlines, options);
      ASSERT_FALSE(shaped);
      EXPECT_EQ(shaped.error().kind, FaultKind::kInvalidOption);
    }
  }
  const auto many = ShapeOutlines(std::vector<Outline>{Star({0, 0}, kMaxExpandedPoints + 1, 1)},
                                  {.expansion = 1});
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(DetailOf(many.error(), "limit"), std::to_string(kMaxExpandedPoints));
  // All arcs cross all others.
  const auto wild = ShapeOutlines(std::vector<Outline>{Star({0, 0}, 6000, 1)}, {.expansion = 15});
  ASSERT_FALSE(wild);
  EXPECT_EQ(wild.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(DetailOf(wild.error(), "limit"), std::to_string(kMostToExpand));
}

// However often it is asked: whenever the caller has given up it ends there.
TEST(ShapeOutlines, EndsWhenItsCallerHasGivenUp) {
  const std::vector<Outline> star{Star({0, 0}, 2000, 3)};
  const OutlineOptions options{.tolerance = 0.01, .expansion = 0.05};
  std::size_t asked = 0;
  const CancelToken counting([&asked] {
    ++asked;
    return Status();
  });
  ASSERT_TRUE(ShapeOutlines(star, options, counting));
  ASSERT_GT(asked, 50u);
  const std::size_t last = asked;
  for (const std::size_t when : {std::size_t{1}, last / 4, last / 2, 3 * last / 4, last}) {
    asked = 0;
    const auto shaped = ShapeOutlines(
        star, options, CancelToken([&asked, when] {
          return ++asked < when ? Status() : Status(Fail(FaultKind::kCancelled, "Enough."));
        }));
    ASSERT_FALSE(shaped);
    EXPECT_EQ(shaped.error().kind, FaultKind::kCancelled);
    EXPECT_EQ(asked, when);
  }
}

}  // namespace
}  // namespace arap
