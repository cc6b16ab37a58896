// Curves moved outwards, and united by Clipper: what seam allowances and expansions are made of.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <clipper.hpp>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/outline.h"

namespace arap {

using ClipperLib::Path;
using ClipperLib::Paths;

// Where curves become whole numbers, so that uniting them is exact, and lie so that the sweep of
// Clipper, along y, meets few edges at a time.
class Canvas {
 public:
  // For what comes no further than `reach` beyond the outlines, which are finite.
  Canvas(std::span<const Outline> outlines, double reach);

  // By which the plane is turned.
  Complex turn() const { return turn_; }
  // From one whole number to the next.
  double grid() const { return 1 / scale_; }

  // Without points that fall on the one before.
  Path In(const Outline& outline) const;
  Paths In(std::span<const Outline> outlines) const;
  Outline Out(const Path& path) const;
  std::vector<Outline> Out(const Paths& paths) const;

 private:
  double scale_ = 1;
  Complex turn_ = 1;
};

// The borders of everything that the curves go round as often as `rule` wants, which is on the left
// of them. Cannot be interrupted: ask CanAfford first.
Paths United(const Paths& curves, ClipperLib::PolyFillType rule);

// Takes from `left` what it costs to unite the curves: 1 for a pair of edges that the sweep meets at a
// time, which takes Clipper up to 25 ns, and `crossing` for one that crosses, which takes it up to
// 1.5 µs. False when that is not enough. Takes as long as there are pairs, or `left`: about 7 ns for
// each. Those of `cancel`.
Result<bool> CanAfford(std::span<const Outline> curves, const Canvas& canvas, std::size_t crossing,
                       std::size_t& left, const CancelToken& cancel = {});

// Goes round the outside of corners at a distance.
class Pen {
 public:
  // The tip of a mitred corner is at most `limit` widths from it, and an arc at most `miss` from
  // what is made of it, or half of the width.
  Pen(double width, Corners corners, double limit, double miss);

  // The curve, of points that differ from the one before, moved to its right. What it goes round at
  // least once is the piece and its allowance. Where it bends inwards its sides meet; where they are
  // too short for that it comes back to the corner, and the little loops that this makes count for
  // nothing.
  Outline Moved(const Outline& curve) const;
  std::vector<Outline> Moved(std::span<const Outline> curves) const;

 private:
  void AppendCorner(Complex at, Complex in, Complex out, Outline& curve) const;

  double width_;
  Corners corners_;
  double limit_;
  double arc_;  // radians between points of an arc
};

}  // namespace arap
