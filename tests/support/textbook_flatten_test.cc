// The transcription of §7 flattens developables exactly, and each slip of the print breaks it.
#include <algorithm>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/support/compare.h"
#include "tests/support/print.h"
#include "tests/support/surfaces.h"
#include "tests/support/textbook.h"

namespace arap::testing {
namespace {

using Variant = std::tuple<bool, Weights>;

class TextbookFlattenTest : public ::testing::TestWithParam<Variant> {};

std::string VariantName(const ::testing::TestParamInfo<Variant>& variant) {
  const auto [both_directions, weights] = variant.param;
  return std::string(both_directions ? "both_ways_" : "one_way_") + NameOf(weights);
}

INSTANTIATE_TEST_SUITE_P(Variants, TextbookFlattenTest,
                         ::testing::Combine(::testing::Bool(),
                                            ::testing::Values(Weights::kUniform,
                                                              Weights::kCotangent)),
                         VariantName);

// The first edge of the triangle in the middle of the list.
std::array<std::uint32_t, 2> MiddleEdge(const SurfaceMesh& mesh) {
  const Triangle& t = mesh.triangles[mesh.triangles.size() / 2];
  return {t[0], t[1]};
}

TEST_P(TextbookFlattenTest, DevelopablesComeOutIsometric) {
  const auto [both_directions, weights] = GetParam();
  for (const Developable& sheet : {RolledSheet(9, 4, 9, 4, 1.2, 1), Accordion(8, 4, 8, 4, 2.4, 2),
                                   ConePatch(9, 3, 1, 4, 4.3, 5.9, 3)}) {
    const auto [a, b] = MiddleEdge(sheet.surface);
    std::vector<Complex> first;
    const auto flat = TextbookFlatten(sheet.surface, both_directions, weights, a, b, &first);
    EXPECT_LT(RelativeDistanceUpToMotion(flat, sheet.flat), 1e-10);
    EXPECT_LT(RelativeDistanceUpToMotion(first, sheet.flat), 1e-10);
    EXPECT_EQ(flat[a], Complex(0, 0));
    EXPECT_EQ(first[a], Complex(0, 0));
    EXPECT_EQ(first[b].imag(), 0);
  }
}

TEST_P(TextbookFlattenTest, SphereCapFlattensWithoutFlips) {
  const auto [both_directions, weights] = GetParam();
  const SurfaceMesh cap = SphereCap(4, 12, 0.8);
  const auto flat = TextbookFlatten(cap, both_directions, weights, 0, 1);
  EXPECT_EQ(CountFlipped(cap.triangles, flat), 0U);
  // True to size: the diameter lies between chord and arc.
  EXPECT_GT(Diagonal(flat), 2 * std::sqrt(2.0) * std::sin(0.8) * 0.95);
  EXPECT_LT(Diagonal(flat), 2 * std::sqrt(2.0) * 0.8 * 1.05);
}

TEST(PrintedSlips, BothWingsOnOneSideFlipTriangles) {
  // On a flat patch, as bad as it can be: nothing needs to be bent at all.
  const Developable sheet = RolledSheet(8, 8, 8, 8, 0, 4);
  const auto [a, b] = MiddleEdge(sheet.surface);
  const auto flipped = [&, a = a, b = b](Slip slip) {
    return CountFlipped(
        sheet.surface.triangles,
        TextbookFlatten(sheet.surface, false, Weights::kUniform, a, b, nullptr, slip));
  };
  EXPECT_EQ(flipped(Slip::kNone), 0U);
  EXPECT_GT(flipped(Slip::kSameSide), sheet.surface.triangles.size() / 10);
}

TEST(PrintedSlips, BoundaryTrianglesAlwaysAboveBreakDevelopables) {
  const Developable sheet = RolledSheet(8, 4, 8, 4, 1, 5);
  const auto [a, b] = MiddleEdge(sheet.surface);
  const auto error = [&, a = a, b = b](Slip slip) {
    return RelativeDistanceUpToMotion(
        TextbookFlatten(sheet.surface, false, Weights::kUniform, a, b, nullptr, slip), sheet.flat);
  };
  EXPECT_LT(error(Slip::kNone), 1e-10);
  EXPECT_GT(error(Slip::kBoundaryAbove), 1e-2);
}

}  // namespace
}  // namespace arap::testing
