#include "core/drawing/svg/view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace arap::cli {

void Bounds::Add(std::span<const double> points) {
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    const double x = points[i];
    const double y = points[i + 1];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    if (empty) {
      *this = {x, y, x, y, false};
    } else {
      min_x = std::min(min_x, x);
      min_y = std::min(min_y, y);
      max_x = std::max(max_x, x);
      max_y = std::max(max_y, y);
    }
  }
}

View::View(const Bounds& bounds, double left, double top, double width, double height) {
  const double along_x = bounds.width() > 0 ? width / bounds.width() : INFINITY;
  const double along_y = bounds.height() > 0 ? height / bounds.height() : INFINITY;
  scale_ = std::min(along_x, along_y);
  if (!std::isfinite(scale_)) scale_ = 1;  // a single point
  offset_x_ = left + (width - scale_ * bounds.width()) / 2 - scale_ * bounds.min_x;
  offset_y_ = top + (height - scale_ * bounds.height()) / 2 + scale_ * bounds.max_y;
}

long View::X(double x) const { return std::lround(offset_x_ + scale_ * x); }
long View::Y(double y) const { return std::lround(offset_y_ - scale_ * y); }

}  // namespace arap::cli
