// How a part of the plane is placed in a picture.
#pragma once

#include <span>

namespace arap::cli {

// The smallest box round everything that it was shown.
struct Bounds {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  bool empty = true;

  // Points x y x y…; points that are not finite are passed over.
  void Add(std::span<const double> points);
  double width() const { return max_x - min_x; }
  double height() const { return max_y - min_y; }
};

// Maps the plane (y up) to whole picture units (y down).
class View {
 public:
  // Fits `bounds` into the middle of the box at `left`, `top`, keeping its proportions.
  View(const Bounds& bounds, double left, double top, double width, double height);

  long X(double x) const;
  long Y(double y) const;

 private:
  double scale_;
  double offset_x_;
  double offset_y_;
};

}  // namespace arap::cli
