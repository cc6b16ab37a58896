// PNG files for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace arap::cli {

struct Pixel {
  std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
};

// The bytes of a PNG file of width · height pixels, row by row from the top; without `alpha` it has
// no alpha channel.
std::string PngBytes(std::size_t width, std::size_t height, const std::vector<Pixel>& pixels,
                     bool alpha = true);

// The same whose header claims another size, with the checksum that belongs to it.
std::string WithClaim(std::string png, std::uint32_t width, std::uint32_t height);

// pixel(x, y) for the centres of all pixels, y down.
template <class Function>
std::string DrawnPng(std::size_t width, std::size_t height, Function pixel, bool alpha = true) {
  std::vector<Pixel> pixels;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      pixels.push_back(pixel(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
    }
  }
  return PngBytes(width, height, pixels, alpha);
}

}  // namespace arap::cli
