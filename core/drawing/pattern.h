// A flat surface as a drawing at true size, whatever file it goes to: the one model that the writers
// of SVG, DXF and PDF take.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/model/flatten.h"
#include "core/drawing/outline.h"

namespace arap {

// What a line is for; files have a layer for each.
enum class LineKind {
  kOutline,    // where the surface ends
  kSeam,       // where it was cut open
  kAllowance,  // what to cut along when there is an allowance
  kGrain,      // from the first point to the second
};

struct PatternLine {
  LineKind kind = LineKind::kOutline;
  bool closed = false;  // back to the first point, which is not repeated
  std::vector<Complex> points;
};

struct PatternPiece {
  std::string name;  // of the object or group, where it is known
  std::vector<PatternLine> lines;
  Bounds box;  // round the piece, without its allowance
};

// Millimetres, y up. No part of a line is drawn twice: an outline that was cut open in places is
// open lines of kOutline and kSeam in turn, and two sides of a cut that lie on each other are one.
struct Pattern {
  std::vector<PatternPiece> pieces;                    // a piece per chart, in their order
  std::vector<Complex> points;                         // #U, the flat positions
  std::vector<std::uint32_t> piece_of;                 // #U, or kNoPiece
  std::vector<Triangle> triangles;                     // #F, into points
  std::vector<std::array<double, 2>> singular_values;  // #F, or empty
  std::vector<Warning> warnings;

  // Round everything that is drawn.
  Bounds Box() const;
};

inline constexpr std::uint32_t kNoPiece = UINT32_MAX;

struct PatternOptions {
  double millimetres_per_unit = 1;
  double allowance = 0;                    // millimetres, 0: none
  std::span<const GrainLine> grain_lines;  // those that the surface was flattened with
};

// With an allowance, pieces that would come too close are set out in rows; kInvalidOption when an
// outline crosses itself too often to have one. O(#U log #U) without an allowance.
Result<Pattern> MakePattern(const Flattening& flat, const PatternOptions& options);

// How many digits after the point show the smallest piece to a ten-thousandth of its size: 3 where
// all are larger than 10 mm, at most 9.
int DigitsFor(const Pattern& pattern);

}  // namespace arap
