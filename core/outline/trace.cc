#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/outline/outline.h"

namespace arap {

double SignedArea(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    // Against the first point, so that a place far from the origin costs no digits.
    twice += TwiceArea(outline[0], outline[i], outline[(i + 1) % outline.size()]);
  }
  return twice / 2;
}

namespace {

bool EndsAt(const Coverage& coverage, const PixelSide& side) {
  return static_cast<std::size_t>(side.beyond_x()) >= coverage.width ||
         static_cast<std::size_t>(side.beyond_y()) >= coverage.height;
}

// Pixels from the left and from above, as the outline has it.
Complex Placed(const Coverage& coverage, double across, double down) {
  const auto margin = static_cast<double>(coverage.margin);
  return {across - margin, static_cast<double>(coverage.height) - margin - down};
}

// Where the outline crosses from the centre of a pixel to the centre of the next one.
Complex Crossing(const Coverage& coverage, const PixelSide& side) {
  const auto value = [&](std::ptrdiff_t x, std::ptrdiff_t y) {
    return static_cast<double>(coverage.values[static_cast<std::size_t>(y) * coverage.width +
                                               static_cast<std::size_t>(x)]);
  };
  const std::ptrdiff_t x = side.beyond_x(), y = side.beyond_y();
  double along = 0.5;
  if (!EndsAt(coverage, side)) {
    constexpr double kThreshold = kInside - 0.5;  // no pixel has it
    const double inside = value(side.x, side.y), outside = value(x, y);
    along = (inside - kThreshold) / (inside - outside);
  }
  const double across = static_cast<double>(side.x) + 0.5 + along * static_cast<double>(x - side.x);
  const double down = static_cast<double>(side.y) + 0.5 + along * static_cast<double>(y - side.y);
  return Placed(coverage, across, down);
}

// Whether `b` lies straight between its neighbours.
bool Straight(Complex a, Complex b, Complex c) {
  return TwiceArea(a, b, c) == 0 && Dot(b - a, c - b) > 0;
}

// Whether the image ends at both sides, in a corner of it.
bool InCorner(const Coverage& coverage, const PixelSide& side, const PixelSide& next) {
  return side.x == next.x && side.y == next.y && EndsAt(coverage, side) && EndsAt(coverage, next);
}

Complex Corner(const Coverage& coverage, const PixelSide& side, const PixelSide& next) {
  return Placed(coverage, static_cast<double>(side.beyond_x() + next.beyond_x() + 1) / 2,
                static_cast<double>(side.beyond_y() + next.beyond_y() + 1) / 2);
}

void Append(Complex point, Outline& outline) {
  const std::size_t n = outline.size();
  if (n > 1 && Straight(outline[n - 2], outline[n - 1], point)) outline.pop_back();
  outline.push_back(point);
}

}  // namespace

Result<std::vector<Outline>> TraceOutlines(const Coverage& coverage) {
  std::vector<Outline> outlines;
  std::size_t points = 0;
  Borders borders(coverage);
  while (borders.Find()) {
    Outline& outline = outlines.emplace_back();
    PixelSide side = borders.start();
    do {
      Append(Crossing(coverage, side), outline);
      const PixelSide next = side.Next(coverage);
      if (InCorner(coverage, side, next)) Append(Corner(coverage, side, next), outline);
      side = next;
      if (points + outline.size() > kMaxOutlinePoints) {
        return Fail(Fault(FaultKind::kLimitExceeded,
                          fmt::format("The outlines have more than {} points: make the image "
                                      "smaller or smoother, or drop larger specks.",
                                      kMaxOutlinePoints))
                        .Detail("limit", kMaxOutlinePoints));
      }
    } while (side != borders.start());
    if (Straight(outline[outline.size() - 2], outline.back(), outline[0])) outline.pop_back();
    if (Straight(outline.back(), outline[0], outline[1])) outline.erase(outline.begin());
    points += outline.size();
  }
  return outlines;
}

}  // namespace arap
