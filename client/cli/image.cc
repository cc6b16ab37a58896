#include "client/cli/image.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include "core/files/text_file.h"

namespace arap::cli {
namespace {

// What is to be freed of an image that was not read to its end.
struct PngReader {
  png_image image{};

  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

// Deflate makes no byte of more than 1032, and a pixel has at least a bit.
bool FileIsTooShort(std::FILE* file, std::size_t pixels) {
  const long here = std::ftell(file);
  if (here < 0 || std::fseek(file, 0, SEEK_END) != 0) return false;  // a pipe
  const long size = std::ftell(file);
  std::fseek(file, here, SEEK_SET);
  return size >= 0 && pixels / (8 * 1032) > static_cast<std::size_t>(size);
}

// Standard input as a file in which one can go back; null with errno when there is none.
std::FILE* SpooledInput() {
  const Result<std::string> bytes = ReadBytes(std::string(kStandardStream));
  errno = EINVAL;
  std::FILE* const file = bytes ? std::tmpfile() : nullptr;
  if (file != nullptr) {
    std::fwrite(bytes->data(), 1, bytes->size(), file);
    std::rewind(file);
  }
  return file;
}

std::uint32_t BigEndian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U |
         std::uint32_t{bytes[2]} << 8U | std::uint32_t{bytes[3]};
}

// What is wrong with the chunks that follow the signature, up to the last one; empty: nothing.
// libpng stops at the last pixel and does not look at the checksum behind it.
std::string WrongChunk(std::FILE* file) {
  std::vector<std::uint8_t> buffer(1U << 16U);
  constexpr long kSignature = 8;
  if (std::fseek(file, kSignature, SEEK_SET) != 0) return "it cannot be read twice";
  while (true) {
    if (std::fread(buffer.data(), 1, 8, file) != 8) return "it ends before its last chunk";
    const std::string name(buffer.begin() + 4, buffer.begin() + 8);
    uLong checksum = crc32(0, buffer.data() + 4, 4);
    for (std::size_t left = BigEndian(buffer.data()); left > 0;) {
      const std::size_t count = std::fread(buffer.data(), 1, std::min(left, buffer.size()), file);
      if (count == 0) return fmt::format("it ends within its chunk {}", name);
      checksum = crc32(checksum, buffer.data(), static_cast<uInt>(count));
      left -= count;
    }
    if (std::fread(buffer.data(), 1, 4, file) != 4) {
      return fmt::format("it ends within its chunk {}", name);
    }
    // What begins with a small letter may be damaged: no pixel depends on it.
    const bool needed = (static_cast<unsigned char>(name[0]) & 0x20U) == 0;
    if (needed && BigEndian(buffer.data()) != checksum) {
      return fmt::format("the checksum of its chunk {} is wrong", name);
    }
    if (name == "IEND") return {};
  }
}

constexpr std::uint8_t kHalfOpaque = 128;

// Puts `threshold` where a coverage has it, and leaves 0 and 255 where they are, so that hard edges
// stay between two pixels whatever the threshold.
std::array<std::uint8_t, 256> Levels(std::uint8_t threshold) {
  std::array<std::uint8_t, 256> levels{};
  const int from = threshold;
  for (int value = 0; value < 256; ++value) {
    int level = 0;
    if (value >= from) {
      level = from == 255 ? 255 : kInside + (value - from) * (255 - kInside) / (255 - from);
    } else if (from > 1) {
      level = value * (kInside - 1) / (from - 1);
    }
    levels[static_cast<std::size_t>(value)] = static_cast<std::uint8_t>(level);
  }
  return levels;
}

std::uint8_t Difference(const std::uint8_t* pixel, const Colour& colour) {
  int largest = 0;
  for (std::size_t k = 0; k < colour.size(); ++k) {
    largest = std::max(largest, std::abs(pixel[k] - colour[k]));
  }
  return static_cast<std::uint8_t>(largest);
}

// level(pixel) for every pixel.
template <class Level>
Coverage Cover(const Image& image, Level level) {
  Coverage coverage{image.width, image.height, 0, {}};
  coverage.values.resize(image.width * image.height);
  for (std::size_t i = 0; i < coverage.values.size(); ++i) {
    coverage.values[i] = level(image.rgba.data() + 4 * i);
  }
  return coverage;
}

}  // namespace

Result<Image> ReadPng(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      path == kStandardStream ? SpooledInput() : std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) {
    return Fail(FaultKind::kNotFound,
                fmt::format("cannot read {}: {}", path, std::generic_category().message(errno)));
  }
  PngReader reader;
  if (png_image_begin_read_from_stdio(&reader.image, file.get()) == 0) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("{}: not a readable PNG file: {}", path, reader.image.message));
  }
  Image image{reader.image.width, reader.image.height, {}};
  const std::size_t pixels = image.width * image.height;
  if (std::max(image.width, image.height) > kMaxImageSide || pixels > kMaxImagePixels) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("{}: an image of {} × {} pixels; at most {} on a side and {} in "
                                  "all are read.",
                                  path, image.width, image.height, kMaxImageSide, kMaxImagePixels))
                    .Detail("limit", kMaxImagePixels));
  }
  if (FileIsTooShort(file.get(), pixels)) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("{}: claims {} × {} pixels, which a file of this length cannot hold.",
                            path, image.width, image.height));
  }
  const auto broken = [&](std::string_view why) {
    return Fail(FaultKind::kInvalidOption, fmt::format("{}: a broken PNG file: {}", path, why));
  };
  const long here = std::ftell(file.get());
  if (const std::string wrong = WrongChunk(file.get()); !wrong.empty()) return broken(wrong);
  std::fseek(file.get(), here, SEEK_SET);
  image.rgba.resize(4 * pixels);
  reader.image.format = PNG_FORMAT_RGBA;
  if (png_image_finish_read(&reader.image, nullptr, image.rgba.data(), 0, nullptr) == 0) {
    return broken(reader.image.message);
  }
  return image;
}

std::size_t TransparentPixels(const Image& image, std::uint8_t threshold) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] < threshold;
  return count;
}

Coverage CoverByAlpha(const Image& image, std::uint8_t threshold) {
  const auto levels = Levels(threshold);
  return Cover(image, [&](const std::uint8_t* pixel) { return levels[pixel[3]]; });
}

Coverage CoverByColour(const Image& image, const Colour& background, std::uint8_t threshold) {
  const auto levels = Levels(threshold);
  return Cover(image, [&](const std::uint8_t* pixel) {
    return std::min(levels[Difference(pixel, background)], pixel[3]);
  });
}

Result<Colour> BorderColour(const Image& image, std::uint8_t threshold) {
  std::vector<const std::uint8_t*> border;
  for (std::size_t y = 0; y < image.height; ++y) {
    const bool whole_row = y == 0 || y + 1 == image.height;
    const std::size_t step = whole_row || image.width < 2 ? 1 : image.width - 1;
    for (std::size_t x = 0; x < image.width; x += step) {
      const std::uint8_t* const pixel = image.rgba.data() + 4 * (y * image.width + x);
      if (pixel[3] >= kHalfOpaque) border.push_back(pixel);
    }
  }
  if (border.empty()) {
    return Fail(FaultKind::kInvalidOption,
                "The border of the image is transparent: it has no background colour.");
  }
  Colour colour{};
  for (std::size_t k = 0; k < colour.size(); ++k) {
    const auto middle = border.begin() + static_cast<std::ptrdiff_t>(border.size() / 2);
    std::nth_element(border.begin(), middle, border.end(),
                     [k](const auto* a, const auto* b) { return a[k] < b[k]; });
    colour[k] = (*middle)[k];
  }
  const auto alike = static_cast<std::size_t>(std::count_if(
      border.begin(), border.end(),
      [&](const std::uint8_t* pixel) { return Difference(pixel, colour) < threshold; }));
  if (2 * alike < border.size()) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("The border of the image has no one colour: only {} of its {} pixels "
                            "are within {} of #{:02x}{:02x}{:02x}. Tell the colour of the "
                            "background (--background RRGGBB).",
                            alike, border.size(), threshold, colour[0], colour[1], colour[2]));
  }
  return colour;
}

}  // namespace arap::cli
