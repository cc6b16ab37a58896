// Pictures of a mesh that moves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace arap::cli {

// Frames of one mesh with its handles.
struct Film {
  std::vector<std::uint32_t> triangles;      // i j k…
  std::vector<std::vector<double>> shapes;   // per frame: x y x y… of the vertices
  std::vector<std::vector<double>> handles;  // per frame: x y x y… of the handle targets, as many
                                             // in each; NaN: not there
  std::vector<std::size_t> numbers;          // per frame: its number in the track
  std::vector<std::string> labels;           // per frame, or empty: "frame <number>"
  std::string caption;

  std::size_t frame_count() const { return shapes.size(); }
};

// An animation that loops, one second for 30 frames of the film. Long films and large meshes are
// thinned out so that the file stays within a few megabytes. Needs at least one frame.
std::string FormatAnimation(const Film& film);

// A still sheet of `count` frames, evenly chosen, first and last among them.
std::string FormatSheet(const Film& film, std::size_t count);

// `count` of `total` indices, evenly spread, first and last among them; all when there are fewer.
std::vector<std::size_t> Spread(std::size_t total, std::size_t count);

}  // namespace arap::cli
