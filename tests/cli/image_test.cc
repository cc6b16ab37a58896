#include "client/cli/image.h"

#include <gmock/gmock.h>

#include "tests/cli/png.h"
#include "tests/support/folder.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

class ReadPngTest : public FolderTest {
 protected:
  // The fault of a file with these bytes.
  Fault FaultOf(const std::string& bytes) const {
    const auto image = ReadPng(Put("image.png", bytes));
    EXPECT_FALSE(image);
    if (image) return {};
    EXPECT_THAT(image.error().message, HasSubstr(Path("image.png")));
    return image.error();
  }
};

std::string Gradient(bool alpha) {
  return DrawnPng(
      7, 5,
      [](double x, double y) {
        return Pixel{static_cast<std::uint8_t>(30 * x), static_cast<std::uint8_t>(40 * y), 9,
                     static_cast<std::uint8_t>(20 * (x + y))};
      },
      alpha);
}

TEST_F(ReadPngTest, PixelsAreReadRowByRowFromTheTop) {
  for (const bool alpha : {true, false}) {
    const auto image = ReadPng(Put("image.png", Gradient(alpha)));
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->width, 7u);
    EXPECT_EQ(image->height, 5u);
    ASSERT_EQ(image->rgba.size(), 4u * 35);
    const std::size_t at = 4 * (2 * 7 + 3);  // x 3.5, y 2.5
    EXPECT_EQ(image->rgba[at], 105);
    EXPECT_EQ(image->rgba[at + 1], 100);
    EXPECT_EQ(image->rgba[at + 2], 9);
    EXPECT_EQ(image->rgba[at + 3], alpha ? 120 : 255);
  }
}

TEST_F(ReadPngTest, WhatIsNoPngOrBrokenIsRefused) {
  const std::string png = Gradient(true);
  EXPECT_EQ(FaultOf("").kind, FaultKind::kInvalidOption);
  EXPECT_EQ(FaultOf("GIF89a, and no PNG at all").kind, FaultKind::kInvalidOption);
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "v 0 0 0\n";
  EXPECT_EQ(FaultOf(text).kind, FaultKind::kInvalidOption);
  for (std::size_t length = 1; length < png.size(); ++length) {
    EXPECT_EQ(FaultOf(png.substr(0, length)).kind, FaultKind::kInvalidOption) << length;
  }
  EXPECT_EQ(ReadPng(Path("absent.png")).error().kind, FaultKind::kNotFound);
  EXPECT_FALSE(ReadPng(Path("")));  // a folder
}

// A flipped bit is refused, or is in a chunk that no pixel depends on.
TEST_F(ReadPngTest, NoFlippedBitChangesAPixel) {
  const std::string png = Gradient(true);
  const auto whole = ReadPng(Put("image.png", png));
  ASSERT_TRUE(whole);
  std::size_t refused = 0;
  for (std::size_t bit = 0; bit < 8 * png.size(); ++bit) {
    std::string bad = png;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    const auto image = ReadPng(Put("image.png", bad));
    refused += !image;
    if (image) {
      EXPECT_EQ(image->rgba, whole->rgba) << bit;
    }
  }
  EXPECT_GT(refused, 4 * png.size());
}

TEST_F(ReadPngTest, ClaimsAreNotBelieved) {
  const std::string png = Gradient(true);
  for (const auto& [width, height, kind] :
       {std::tuple{16'385u, 1u, FaultKind::kInvalidOption},
        std::tuple{1u, 60'000u, FaultKind::kInvalidOption},
        std::tuple{16'384u, 16'384u, FaultKind::kInvalidOption},
        std::tuple{8'192u, 8'192u, FaultKind::kInvalidOption},  // the file is too short for it
        std::tuple{2'147'483'647u, 2'147'483'647u, FaultKind::kInvalidOption},
        std::tuple{0u, 5u, FaultKind::kInvalidOption},
        std::tuple{8u, 5u, FaultKind::kInvalidOption}}) {
    EXPECT_EQ(FaultOf(WithClaim(png, width, height)).kind, kind) << width << " " << height;
  }
  EXPECT_TRUE(ReadPng(Put("image.png", WithClaim(png, 7, 5))));
}

Image OnePixel(Pixel pixel) { return {1, 1, {pixel.red, pixel.green, pixel.blue, pixel.alpha}}; }

TEST(CoverByAlpha, ThresholdsAndNothingAndAllStayWhatTheyAre) {
  for (int threshold = 1; threshold <= 255; ++threshold) {
    int before = 0;
    for (int alpha = 0; alpha <= 255; ++alpha) {
      const Coverage coverage = CoverByAlpha(OnePixel({0, 0, 0, static_cast<std::uint8_t>(alpha)}),
                                             static_cast<std::uint8_t>(threshold));
      EXPECT_EQ(coverage.Inside(0, 0), alpha >= threshold) << alpha << " at " << threshold;
      EXPECT_GE(coverage.values[0], before);
      before = coverage.values[0];
      if (alpha == 0) {
        EXPECT_EQ(before, 0);
      }
    }
    EXPECT_EQ(before, 255);
  }
}

TEST(CoverByColour, TheLargestDifferenceOfAChannelCounts) {
  const Colour background{200, 100, 50};
  EXPECT_FALSE(CoverByColour(OnePixel({231, 69, 81}), background, 32).Inside(0, 0));
  EXPECT_TRUE(CoverByColour(OnePixel({200, 100, 82}), background, 32).Inside(0, 0));
  EXPECT_TRUE(CoverByColour(OnePixel({168, 100, 50}), background, 32).Inside(0, 0));
  EXPECT_FALSE(CoverByColour(OnePixel({0, 0, 0, 127}), background, 32).Inside(0, 0));
}

TEST(BorderColour, IsWhatMostOfTheBorderHas) {
  Image image{10, 10, {}};
  for (int i = 0; i < 100; ++i) {
    const bool border = i % 10 == 0 || i % 10 == 9 || i < 10 || i >= 90;
    // A figure that reaches over a third of the lower border.
    const bool figure = !border || (i >= 92 && i < 98);
    const auto grey = static_cast<std::uint8_t>(figure ? 10 : 240 + i % 3);
    image.rgba.insert(image.rgba.end(), {grey, 250, grey, 255});
  }
  const auto colour = BorderColour(image, 32);
  ASSERT_TRUE(colour) << colour.error().message;
  EXPECT_NEAR((*colour)[0], 241, 1);
  EXPECT_EQ((*colour)[1], 250);

  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    image.rgba[i] = static_cast<std::uint8_t>(i * 97);
  }
  const auto motley = BorderColour(image, 32);
  ASSERT_FALSE(motley);
  EXPECT_THAT(motley.error().message, HasSubstr("--background RRGGBB"));

  EXPECT_TRUE(BorderColour(OnePixel({1, 2, 3}), 1));
  EXPECT_FALSE(BorderColour(OnePixel({1, 2, 3, 0}), 1));
}

}  // namespace
}  // namespace arap::cli
