// A shape as two arrays (#V each), because the rigid solve takes x and y as two right-hand sides.
#pragma once

namespace arap {

struct ConstShapeView {
  const double* x;
  const double* y;
};
struct ShapeView {
  double* x;
  double* y;
};

}  // namespace arap
