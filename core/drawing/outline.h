// Curves of the plane and the box round them.
#pragma once

#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// The smallest box round everything that it was shown.
struct Bounds {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  bool empty = true;

  // A point that is not finite is passed over.
  void Add(Complex point);
  void Add(std::span<const Complex> points);
  Bounds Moved(Complex by) const;
  double width() const { return max_x - min_x; }
  double height() const { return max_y - min_y; }
};

// A closed curve; the first point is not repeated.
using Ring = std::vector<Complex>;

}  // namespace arap
