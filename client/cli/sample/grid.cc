#include "client/cli/sample/grid.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "client/cli/sample/place_handle.h"

namespace arap::cli {

PlanarMesh MakeGrid(std::size_t columns, std::size_t rows) {
  PlanarMesh mesh;
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < columns; ++x) {
      mesh.vertices.emplace_back(static_cast<double>(x), static_cast<double>(y));
    }
  }
  for (std::size_t y = 0; y + 1 < rows; ++y) {
    for (std::size_t x = 0; x + 1 < columns; ++x) {
      const auto a = static_cast<std::uint32_t>(y * columns + x);
      const std::uint32_t b = a + 1;
      const auto d = static_cast<std::uint32_t>(a + columns);
      const std::uint32_t c = d + 1;
      if ((x + y) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
      }
    }
  }
  return mesh;
}

Track MakeGridTrack(const PlanarMesh& mesh, std::size_t columns, std::size_t rows) {
  constexpr int kFrames = 60;
  constexpr double kLargestAngle = std::numbers::pi / 2;
  const double width = static_cast<double>(columns - 1);
  const double height = static_cast<double>(rows - 1);
  const Point middle(width / 2, height / 2);
  const std::array<Point, 4> corners{Point(width / 8, height / 8), Point(width * 7 / 8, height / 8),
                                     Point(width * 7 / 8, height * 7 / 8),
                                     Point(width / 8, height * 7 / 8)};
  Track track;
  constexpr std::array<const char*, 4> kNames{"lower_left", "lower_right", "upper_right",
                                              "upper_left"};
  for (std::size_t k = 0; k < corners.size(); ++k) AddHandle(mesh, kNames[k], corners[k], track);
  for (int i = 0; i < kFrames; ++i) {
    const double s = std::sin(std::numbers::pi * i / kFrames);
    const Point turn = std::polar(1.0, kLargestAngle * s * s);
    TrackFrame& frame = track.frames.emplace_back();
    frame.kind = i == 0 ? "rest" : "turn";
    for (const Point corner : corners) {
      const bool right = corner.real() > middle.real();
      frame.targets.push_back(
          {.position = right && i > 0 ? Rounded(middle + turn * (corner - middle)) : corner});
    }
  }
  return track;
}

}  // namespace arap::cli
