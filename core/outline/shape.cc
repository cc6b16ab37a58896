#include "core/outline/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/outline/asked.h"
#include "core/outline/offset.h"
#include "core/outline/outline.h"

namespace arap {
namespace {

// Of the box round the outlines.
double DiagonalOf(std::span<const Outline> outlines) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::array<double, 2> low{kInfinite, kInfinite}, high{-kInfinite, -kInfinite};
  for (const Outline& outline : outlines) {
    for (const Complex p : outline) {
      low = {std::min(low[0], p.real()), std::min(low[1], p.imag())};
      high = {std::max(high[0], p.real()), std::max(high[1], p.imag())};
    }
  }
  return high[0] < low[0] ? 0 : std::hypot(high[0] - low[0], high[1] - low[1]);
}

Status CheckLength(double length, const char* field) {
  if (std::isfinite(length) && length >= 0) return {};
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("The {} is {}: a finite number from 0 is meant.", field, length))
                  .Field(field));
}

Fault TooCostly(const char* why, std::size_t limit) {
  return Fault(FaultKind::kLimitExceeded,
               fmt::format("{} A larger tolerance simplifies the outlines more before they grow.",
                           why))
      .Field("expansion")
      .Detail("limit", limit);
}

// How the error that is allowed is shared out.
struct Shares {
  double before = 0, arcs = 0, after = 0;  // simplified, grown, simplified again
};

Shares ShareOut(const OutlineOptions& options) {
  constexpr double kFinestArcs = 2e-3, kUsualArcs = 1e-2, kCoarsestArcs = 0.25;  // of the expansion
  const double tolerance = options.tolerance, expansion = options.expansion;
  if (tolerance == 0) return {0, kUsualArcs * expansion, 0};
  return {tolerance / 2,
          std::clamp(tolerance / 4, kFinestArcs * expansion, kCoarsestArcs * expansion),
          tolerance / 4};
}

struct Grown {
  std::vector<Outline> outlines;
  double rounding = 0;  // how far a point may be off
};

// Everything within `distance` of what lies inside; the outlines neither cross nor touch.
Result<Grown> Grow(std::span<const Outline> outlines, double distance, double miss,
                   const CancelToken& cancel) {
  const Canvas canvas(outlines, 2 * distance);
  constexpr std::size_t kCrossing = 50;
  std::size_t left = kMostToExpand;
  const auto afford = [&](std::span<const Outline> curves) -> Status {
    TRY(const bool affordable, CanAfford(curves, canvas, kCrossing, left, cancel));
    if (affordable) return {};
    return Fail(TooCostly("What the outlines grow to crosses itself too often.", kMostToExpand));
  };
  CHECK_OK(afford(outlines));
  // Pieces on the left of their borders.
  const std::vector<Outline> inside =
      canvas.Out(United(canvas.In(outlines), ClipperLib::pftEvenOdd));
  constexpr double kNoTips = 1;  // of round corners
  const std::vector<Outline> curves = Pen(distance, Corners::kRound, kNoTips, miss).Moved(inside);
  CHECK_OK(afford(curves));
  Paths borders = United(canvas.In(curves), ClipperLib::pftNonZero);
  // Holes that have closed all but a speck.
  std::erase_if(borders, [&](const Path& border) {
    return border.size() < 3 ||
           std::abs(ClipperLib::Area(border)) * canvas.grid() * canvas.grid() < miss * miss;
  });
  constexpr double kRoundings = 4;  // in, out, and of both where lines cross
  return Grown{canvas.Out(borders), kRoundings * canvas.grid()};
}

// Grown and simple again. Where that happens to touch itself, growing a little more parts or joins
// it.
Result<ShapedOutlines> GrowApart(std::span<const Outline> outlines, double distance,
                                 const Shares& shares, const CancelToken& cancel) {
  constexpr int kTries = 4;
  const double little = shares.arcs / 16;
  Fault touching;
  for (int i = 0; i < kTries; ++i) {
    const double more = i * little;
    TRY(Grown grown, Grow(outlines, distance + more, shares.arcs, cancel));
    auto simple = SimplifyOutlines(grown.outlines, shares.after, cancel);
    if (simple) {
      return ShapedOutlines{*std::move(simple),
                            shares.before + shares.arcs + shares.after + more + grown.rounding};
    }
    if (simple.error().kind != FaultKind::kInvalidOption) return Fail(std::move(simple.error()));
    touching = std::move(simple.error());
  }
  touching.message = "When they grow: " + touching.message;
  return Fail(std::move(touching).Field("expansion"));
}

}  // namespace

Status CheckShaping(std::span<const Outline> outlines, const OutlineOptions& options) {
  CHECK_OK(CheckLength(options.tolerance, "tolerance"));
  CHECK_OK(CheckLength(options.expansion, "expansion"));
  CHECK_OK(CheckOutlines(outlines));
  if (const double diagonal = DiagonalOf(outlines); options.expansion > diagonal) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("The expansion is {:g}: it can be at most {:g}, the diagonal of "
                                  "the box round the outlines.",
                                  options.expansion, diagonal))
                    .Field("expansion")
                    .Detail("limit", diagonal));
  }
  return {};
}

Result<ShapedOutlines> ShapeOutlines(std::span<const Outline> outlines,
                                     const OutlineOptions& options, const CancelToken& cancel) {
  CHECK_OK(CheckShaping(outlines, options));
  if (options.tolerance == 0 && options.expansion == 0) {
    return ShapedOutlines{{outlines.begin(), outlines.end()}, 0};
  }
  const Complex origin = OriginOf(outlines);
  const std::vector<Outline> near = CountedFrom(origin, outlines);
  ShapedOutlines shaped;
  if (options.expansion == 0) {
    TRY(shaped.outlines, SimplifyOutlines(near, options.tolerance, cancel));
    shaped.error = options.tolerance;
  } else {
    const Shares shares = ShareOut(options);
    TRY(const std::vector<Outline> simple, SimplifyOutlines(near, shares.before, cancel));
    if (const std::size_t points = PointsOf(simple); points > kMaxExpandedPoints) {
      return Fail(TooCostly(fmt::format("The outlines have {} points, more than {} that can grow.",
                                        points, kMaxExpandedPoints)
                                .c_str(),
                            kMaxExpandedPoints));
    }
    try {
      TRY(shaped, GrowApart(simple, options.expansion, shares, cancel));
    } catch (const ClipperLib::clipperException& error) {
      return Fail(Fault(FaultKind::kInvalidOption, "The outlines cannot grow.")
                      .Field("expansion")
                      .Detail("cause", error.what()));
    }
    shaped.error += std::abs(origin) * std::numeric_limits<double>::epsilon();
  }
  shaped.outlines = CountedFrom(-origin, shaped.outlines);
  return shaped;
}

ShapingCost EstimateShaping(std::size_t points, const OutlineOptions& options) {
  if (options.tolerance == 0 && options.expansion == 0) return {};
  constexpr std::size_t kBytesToSimplify = 700;
  const auto count = static_cast<double>(points);
  ShapingCost cost{kSecondsToSimplify * count, kBytesToSimplify * points};
  if (options.expansion > 0) {
    // Measured; memory with arcs of the finest at every corner.
    constexpr double kSecondsToGrow = 20e-6;
    constexpr std::size_t kBytesToGrow = 8000;
    const std::size_t growing = std::min(points, kMaxExpandedPoints);
    cost.seconds += kSecondsToGrow * static_cast<double>(growing) + kSecondsToSimplify * count;
    cost.bytes += kBytesToGrow * growing;
  }
  return cost;
}

}  // namespace arap
