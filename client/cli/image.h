// Images from PNG files, and which of their pixels belong to the figure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "core/outline/coverage.h"

namespace arap::cli {

// What is read: a header that claims more is refused before memory is taken. A pixel needs five
// bytes.
inline constexpr std::size_t kMaxImageSide = 16'384;
inline constexpr std::size_t kMaxImagePixels = 67'108'864;

using Colour = std::array<std::uint8_t, 3>;  // red, green, blue

// Row by row from the top, four bytes a pixel: red, green, blue, alpha (255 where it has none).
struct Image {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// Any PNG; 16 bits are cut to 8. Faults name the file: kNotFound (it cannot be opened),
// kLimitExceeded (larger than the above), kInvalidOption (no PNG, broken, cut off, or a pipe).
Result<Image> ReadPng(const std::string& path);

// How many pixels have an alpha below `threshold`.
std::size_t TransparentPixels(const Image& image, std::uint8_t threshold);

// Pixels of at least this alpha are inside. 1 to 255.
Coverage CoverByAlpha(const Image& image, std::uint8_t threshold);

// Pixels that differ from the background in one channel by at least `threshold` (1 to 255) are
// inside, unless they are transparent: below half of the full alpha.
Coverage CoverByColour(const Image& image, const Colour& background, std::uint8_t threshold);

// The colour of the border of the image: of each channel the median over its pixels that are not
// transparent. kInvalidOption when fewer than half of them differ from it by less than `threshold`.
Result<Colour> BorderColour(const Image& image, std::uint8_t threshold);

}  // namespace arap::cli
