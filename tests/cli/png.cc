#include "tests/cli/png.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

namespace arap::cli {

std::string PngBytes(std::size_t width, std::size_t height, const std::vector<Pixel>& pixels,
                     bool alpha) {
  std::vector<std::uint8_t> bytes;
  for (const Pixel& pixel : pixels) {
    bytes.insert(bytes.end(), {pixel.red, pixel.green, pixel.blue});
    if (alpha) bytes.push_back(pixel.alpha);
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  std::string png(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = png.size();
  EXPECT_NE(png_image_write_to_memory(&image, png.data(), &size, 0, bytes.data(), 0, nullptr), 0)
      << image.message;
  png.resize(size);
  return png;
}

std::string WithClaim(std::string png, std::uint32_t width, std::uint32_t height) {
  const auto put = [&png](std::size_t at, std::uint32_t number) {
    for (std::size_t k = 0; k < 4; ++k) png[at + k] = static_cast<char>(number >> (24 - 8 * k));
  };
  // The header begins after the signature: length, name, width, height, five bytes, checksum.
  constexpr std::size_t kName = 12, kWidth = 16, kHeight = 20, kChecksum = 29;
  put(kWidth, width);
  put(kHeight, height);
  const std::vector<Bytef> checked(png.begin() + kName, png.begin() + kChecksum);
  put(kChecksum,
      static_cast<std::uint32_t>(crc32(0, checked.data(), static_cast<uInt>(checked.size()))));
  return png;
}

}  // namespace arap::cli
