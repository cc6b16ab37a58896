// A flat surface as a drawing at true size, whatever file it goes to: the one model that the writers
// of SVG, DXF and PDF take.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"
#include "core/base/plane.h"

namespace arap {

// What a line is for; files have a layer for each.
enum class LineKind {
  kOutline,    // where the surface ends
  kSeam,       // where it was cut open
  kAllowance,  // what to cut along when there is an allowance
  kGrain,      // from the first point to the second
  kNotch,      // across a seam, where its other side has one too
};

struct PatternLine {
  LineKind kind = LineKind::kOutline;
  bool closed = false;  // back to the first point, which is not repeated
  std::vector<Complex> points;
};

// Text that is level wherever its piece goes.
struct PatternLabel {
  Complex at;  // its middle
  double height = 3;
  std::string text;
  bool is_name = false;  // of the piece, which plain drawings have not
};

struct PatternPiece {
  std::string name;  // of the object or group, where it is known
  std::vector<PatternLine> lines;
  std::vector<PatternLabel> labels;
  Bounds box;  // round the piece, without its allowance
};

// Millimetres, y up. No part of a line is drawn twice: an outline that was cut open in places is
// open lines of kOutline and kSeam in turn, and two sides of a cut that lie on each other are one.
struct Pattern {
  std::vector<PatternPiece> pieces;                    // a piece per chart, in their order
  std::vector<Complex> points;                         // #U, the flat positions
  std::vector<std::uint32_t> piece_of;                 // #U, or kNoPiece
  std::vector<Triangle> triangles;                     // #F, into points
  std::vector<std::array<double, 2>> singular_values;  // #F in single precision, or empty
  // Elements are pieces: "allowance_lost" (it runs into the piece or closes a gap of it) and
  // "allowance_unchecked" (that cannot be told).
  std::vector<Warning> warnings;

  // Round everything that is drawn.
  Bounds Box() const;
};

inline constexpr std::uint32_t kNoPiece = UINT32_MAX;

struct PatternOptions {
  double millimetres_per_unit = 1;
  double allowance = 0;                         // millimetres, 0: none
  std::span<const GrainLine> grain_lines = {};  // those that the surface was flattened with
  Corners corners = Corners::kMitre;            // of the allowance
  bool notches = false;                         // pair the sides of seams (AddNotches)
  double sheet_width = 0;                       // pack into a roll (PackRoll); 0: as they were laid
  std::span<const std::string> names = {};      // of pieces by chart, which are written on them
};

// From the first point of a line to its last: left end, tip and right end of an arrow head of a
// length, at most a third of the line's.
std::array<Complex, 3> ArrowHead(const PatternLine& line, double length);

// With an allowance, pieces that would come too close are set out in rows. `flat` is finite and its
// indices are there. kInvalidOption when an outline crosses itself too often to have an allowance,
// or a piece is too large for the roll; the fault of `cancel`, which is asked between pieces.
// O(#U log #U) without an allowance.
Result<Pattern> MakePattern(const Flattening& flat, const PatternOptions& options,
                            const CancelToken& cancel = {});

// How many digits after the point show the smallest piece to a ten-thousandth of its size: 3 where
// all are larger than 10 mm, at most 9.
int DigitsFor(const Pattern& pattern);

}  // namespace arap
