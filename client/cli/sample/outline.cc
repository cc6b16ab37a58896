#include "client/cli/sample/outline.h"

#include <cmath>
#include <cstddef>

namespace arap::cli {
namespace {

// Follows the outline in steps much finer than the sampling, until it closes.
std::vector<Point> Trace(const Field& field, Point start, double step) {
  constexpr std::size_t kMostSteps = 1'000'000;
  std::vector<Point> fine{start};
  while (fine.size() < kMostSteps) {
    const Point here = fine.back();
    const Point gradient = Gradient(field, here, step * 0.1);
    // The gradient points outwards; a quarter turn to the left of it runs counter-clockwise.
    const Point forward = Point(0, 1) * gradient / std::abs(gradient);
    fine.push_back(Project(field, here + step * forward, step * 0.1));
    if (fine.size() > 4 && std::abs(fine.back() - start) < 0.75 * step) break;
  }
  fine.back() = start;
  return fine;
}

}  // namespace

std::vector<Point> SampleOutline(const Field& field, Point start, double edge) {
  const double step = edge / 16;
  const std::vector<Point> fine = Trace(field, Project(field, start, step * 0.1), step);
  double length = 0;
  for (std::size_t i = 1; i < fine.size(); ++i) length += std::abs(fine[i] - fine[i - 1]);

  // An even number keeps a symmetric outline symmetric when `start` lies on its axis.
  const auto count = 2 * static_cast<std::size_t>(std::lround(length / edge / 2));
  const double spacing = length / static_cast<double>(count);
  std::vector<Point> samples;
  double walked = 0;
  for (std::size_t i = 1; i < fine.size() && samples.size() < count; ++i) {
    const double piece = std::abs(fine[i] - fine[i - 1]);
    for (double next = static_cast<double>(samples.size()) * spacing;
         next < walked + piece && samples.size() < count;
         next = static_cast<double>(samples.size()) * spacing) {
      const double along = (next - walked) / piece;
      const Point chord = fine[i - 1] + along * (fine[i] - fine[i - 1]);
      samples.push_back(Project(field, chord, step * 0.1));
    }
    walked += piece;
  }
  return samples;
}

}  // namespace arap::cli
