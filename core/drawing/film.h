// Pictures of a mesh that moves.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// Frames of one mesh with its handles.
struct Film {
  std::vector<Triangle> triangles;           // #F
  std::vector<std::vector<Complex>> shapes;  // per frame: the vertices (#V)
  // Per frame the handle targets, as many in each; NaN: not there.
  std::vector<std::vector<Complex>> handles;
  std::vector<std::size_t> numbers;  // per frame: its number in the track
  std::vector<std::string> labels;   // per frame, or empty: "frame <number>"
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

}  // namespace arap
