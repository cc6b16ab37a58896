#include "core/drawing/outline.h"

#include <algorithm>
#include <cmath>

namespace arap {

void Bounds::Add(Complex point) {
  const double x = point.real(), y = point.imag();
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  if (empty) {
    *this = {x, y, x, y, false};
    return;
  }
  min_x = std::min(min_x, x);
  min_y = std::min(min_y, y);
  max_x = std::max(max_x, x);
  max_y = std::max(max_y, y);
}

void Bounds::Add(std::span<const Complex> points) {
  for (const Complex point : points) Add(point);
}

Bounds Bounds::Moved(Complex by) const {
  if (empty) return *this;
  return {min_x + by.real(), min_y + by.imag(), max_x + by.real(), max_y + by.imag(), false};
}

}  // namespace arap
