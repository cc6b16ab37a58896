// Coverage: how much of each pixel of an image belongs to the figure on it; and what is done with
// it before its outlines are traced.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "arap/base/result.h"

namespace arap {

// A pixel is inside from this value on; what lies between it and 0 or 255 places the outline
// between the centres of two pixels.
inline constexpr std::uint8_t kInside = 128;

// Row by row from the top, width · height values. Everything round it is outside.
struct Coverage {
  std::size_t width = 0, height = 0;  // with the margin
  std::size_t margin = 0;             // pixels that were added on each side of the image
  std::vector<std::uint8_t> values;

  bool Inside(std::ptrdiff_t x, std::ptrdiff_t y) const {
    const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
    return column < width && row < height && values[row * width + column] >= kInside;
  }
};

// One side of a pixel inside, beyond which lies a pixel outside. Pixels inside that touch in a
// corner belong together, pixels outside do not.
struct PixelSide {
  std::ptrdiff_t x = 0, y = 0;  // of the pixel inside, y down
  int direction = 0;            // to the pixel outside: 0 right, 1 up, 2 left, 3 down

  static constexpr int kUp = 1;
  std::ptrdiff_t beyond_x() const { return x + (direction == 0) - (direction == 2); }
  std::ptrdiff_t beyond_y() const { return y + (direction == 3) - (direction == 1); }
  // The side that follows on the border with the inside on the left.
  PixelSide Next(const Coverage& coverage) const;

  bool operator==(const PixelSide&) const = default;
};

// The borders of a coverage, each once. Needs a bit per pixel. The coverage must outlive it and may
// be changed where borders were found.
class Borders {
 public:
  explicit Borders(const Coverage& coverage);

  // Finds the next border, from the top; false when there is none. O(pixels) for all of them.
  bool Find();
  // An upper side of the border that was found last.
  PixelSide start() const { return start_; }
  // The pixels that it goes round, counter-clockwise or (round a hole) negative.
  std::ptrdiff_t area() const { return area_; }

 private:
  const Coverage& coverage_;
  std::vector<bool> seen_;  // upper sides
  std::size_t next_ = 0;
  PixelSide start_;
  std::ptrdiff_t area_ = 0;
};

struct Dropped {
  std::size_t pieces = 0, holes = 0;
  std::size_t largest_piece = 0;  // its pixels
};

inline constexpr std::size_t kEveryHole = std::numeric_limits<std::size_t>::max();
// Takes away pieces whose border goes round fewer than `least` pixels, and closes holes of fewer
// than `least_hole`. O(pixels).
Dropped DropSpecks(std::size_t least, std::size_t least_hole, Coverage& coverage);

// Everything within `distance` pixels (above 0) of the pixels inside, exact to half a pixel; the
// margin grows so that it fits. O(pixels), four bytes for each.
Coverage Expand(const Coverage& coverage, double distance);

}  // namespace arap
