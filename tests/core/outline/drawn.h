// Coverages and outlines for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/outline/coverage.h"
#include "core/outline/outline.h"

namespace arap::testing {

// Of rows from the top: '#' is inside.
inline Coverage Rows(const std::vector<std::string_view>& rows) {
  Coverage coverage{rows[0].size(), rows.size(), 0, {}};
  for (const std::string_view row : rows) {
    for (const char pixel : row) coverage.values.push_back(pixel == '#' ? 255 : 0);
  }
  return coverage;
}

// `depth` says how far inside a point is, in pixels with y up; edges are as soft as a pixel is wide.
template <class Depth>
Coverage Drawn(std::size_t width, std::size_t height, Depth depth) {
  Coverage coverage{width, height, 0, {}};
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::complex<double> p(static_cast<double>(x) + 0.5,
                                   static_cast<double>(height - y) - 0.5);
      const double value = std::clamp(127.5 + 255 * depth(p), 0.0, 255.0);
      coverage.values.push_back(static_cast<std::uint8_t>(std::lround(value)));
    }
  }
  return coverage;
}

// Pixels that are inside with a probability of `density`.
inline Coverage Noise(std::size_t width, std::size_t height, double density, unsigned seed) {
  std::mt19937 random(seed);
  Coverage coverage{width, height, 0, {}};
  for (std::size_t i = 0; i < width * height; ++i) {
    coverage.values.push_back(static_cast<double>(random()) < density * 4294967296.0 ? 255 : 0);
  }
  return coverage;
}

inline std::size_t CountInside(const Coverage& coverage) {
  return static_cast<std::size_t>(std::count_if(coverage.values.begin(), coverage.values.end(),
                                                [](auto value) { return value >= kInside; }));
}

inline Outline Box(double left, double bottom, double right, double top) {
  return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

// Of pieces less holes, as they run.
inline double AreaOf(const std::vector<Outline>& outlines) {
  double area = 0;
  for (const Outline& outline : outlines) area += SignedArea(outline);
  return area;
}

}  // namespace arap::testing
