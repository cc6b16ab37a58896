// The seam allowance: a closed curve at a distance round a piece.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <clipper.hpp>

#include "core/base/try.h"
#include "core/drawing/pattern_steps.h"
#include "core/outline/offset.h"

namespace arap {
namespace {

// How far the tip of a mitred corner may be from it, in widths.
constexpr double kMiterLimit = 2;
// The same for the way back from the border to the outline, which tells what was lost.
constexpr double kHollowLimit = 3;
constexpr double kTolerance = 0.1;  // of what was lost, in widths

// The length of the curves inside a region.
double LengthInside(const std::vector<Ring>& curves, const Paths& region, const Canvas& canvas) {
  ClipperLib::Clipper clipper;
  for (const Ring& curve : curves) {
    Path path = canvas.In(curve);
    if (path.size() < 2) continue;
    path.push_back(path.front());
    clipper.AddPath(path, ClipperLib::ptSubject, /*Closed=*/false);
  }
  clipper.AddPaths(region, ClipperLib::ptClip, /*Closed=*/true);
  ClipperLib::PolyTree tree;
  clipper.Execute(ClipperLib::ctIntersection, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  Paths inside;
  ClipperLib::OpenPathsFromPolyTree(tree, inside);
  double length = 0;
  for (const Path& path : inside) {
    const Ring line = canvas.Out(path);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) length += std::abs(line[i + 1] - line[i]);
  }
  return length;
}

// How far an arc may be from what is made of it, in millimetres.
double MissOf(double width) { return std::max(0.01, 1e-3 * width); }

// Takes from `left` what it costs to unite the curves.
Status Afford(const std::vector<Ring>& curves, const Canvas& canvas, std::size_t& left) {
  constexpr std::size_t kCrossing = 1000;
  TRY(const bool affordable, CanAfford(curves, canvas, kCrossing, left));
  if (affordable) return {};
  return Fail(Fault(FaultKind::kInvalidOption,
                    "An outline crosses itself too often, or winds too narrowly for the width, to "
                    "have a seam allowance.")
                  .Field("allowance"));
}

// Back from the border to the outline and a little farther is a region that only lost parts of the
// outline are in.
std::optional<double> Lost(const std::vector<Ring>& rings, const Paths& piece, double width,
                           const Canvas& canvas, std::size_t& left) {
  // Mitred, whatever the corners are: arcs would become bends that are narrower than the way back.
  const Pen pen(width, Corners::kMitre, kMiterLimit, MissOf(width));
  std::vector<Ring> border =
      canvas.Out(United(canvas.In(pen.Moved(canvas.Out(piece))), ClipperLib::pftNonZero));
  for (Ring& ring : border) std::reverse(ring.begin(), ring.end());
  const Pen back((1 + kTolerance) * width, Corners::kMitre, kHollowLimit, MissOf(width));
  const std::vector<Ring> inside = back.Moved(border);
  if (!Afford(inside, canvas, left)) return std::nullopt;
  // What is outside or beside the border is gone round as often as not, or more; the region once
  // less.
  return LengthInside(rings, United(canvas.In(inside), ClipperLib::pftNegative), canvas);
}

Result<Allowance> Offset(const std::vector<Ring>& rings, double width, Corners corners,
                         BorderBudget& budget) {
  const Canvas canvas(rings, (kMiterLimit + kHollowLimit) * width);
  CHECK_OK(Afford(rings, canvas, budget.left));
  const Paths piece = United(canvas.In(rings), ClipperLib::pftNonZero);
  const Pen pen(width, corners, kMiterLimit, MissOf(width));
  const std::vector<Ring> outside = pen.Moved(canvas.Out(piece));
  CHECK_OK(Afford(outside, canvas, budget.left));
  Allowance allowance;
  allowance.rings = canvas.Out(United(canvas.In(outside), ClipperLib::pftNonZero));

  allowance.lost = Lost(rings, piece, width, canvas, budget.left_to_check);
  for (Ring& ring : allowance.rings) {
    const auto farthest = std::max_element(ring.begin(), ring.end(), [](Complex a, Complex b) {
      return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
    });
    std::rotate(ring.begin(), farthest, ring.end());
  }
  return allowance;
}

}  // namespace

Result<Allowance> OffsetOutwards(const std::vector<Ring>& rings, double width, Corners corners,
                                 BorderBudget& budget) {
  try {
    return Offset(rings, width, corners, budget);
  } catch (const ClipperLib::clipperException& error) {
    return Fail(Fault(FaultKind::kInvalidOption, "The outline cannot have a seam allowance.")
                    .Field("allowance")
                    .Detail("cause", error.what()));
  }
}

}  // namespace arap
