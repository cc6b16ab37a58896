// Pictures of a mesh that moves.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "core/base/plane.h"

namespace arap {

// Frames of one mesh with its handles, those that are drawn.
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

// An animation that loops in so many seconds, its frames evenly through them. `bounds` is the box
// that it has to fit in. Inner edges are left out where they would make the file larger than a few
// megabytes. Needs at least one frame.
std::string FormatAnimation(const Film& film, double seconds, const Bounds& bounds);

// A still sheet of the frames. Needs at least one.
std::string FormatSheet(const Film& film);

}  // namespace arap
