// Drawings of a flat surface at true size: what to ask for, and the files that come back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

enum class DrawingFormat {
  kSvg,
  kDxf,  // lines and texts on the layers OUTLINE, SEAM, CUT, GRAIN, NOTCH and LABEL; no pages
  kPdf,
};

// How a seam allowance goes round a corner that points outwards.
enum class Corners {
  kMitre,   // the sides go on until they meet; sharp corners are cut off at twice the width
  kSquare,  // cut off at the width
  kRound,   // an arc, within 0.01 of a unit or 1/1000 of the width
};

// Bounds of what can be asked for, in millimetres.
inline constexpr double kMaxMillimetresPerUnit = 1e6;  // and not below one by this
inline constexpr double kMaxAllowance = 1e4;
inline constexpr double kMaxSheetWidth = 1e9;
inline constexpr double kMaxPageMargin = 20;
inline constexpr std::size_t kMaxDrawings = 16;  // of one flattening

// One drawing. Lengths are in millimetres.
struct DrawingOptions {
  DrawingFormat format = DrawingFormat::kSvg;
  double millimetres_per_unit = 1;  // what a unit of the surface is
  double allowance = 0;             // seam allowance round the pieces
  Corners corners = Corners::kMitre;
  bool notches = false;    // pair the sides of seams by short lines with a number
  double sheet_width = 0;  // pack the pieces into a roll; 0: as they were laid
  // Pages to print and join: "A0" to "A5", "letter", "legal", "tabloid" or "WIDTHxHEIGHT". Empty: the
  // sheet in one piece. Pages show lines only.
  std::string paper = {};
  double overlap = 10;    // what pages share with their neighbours
  double margin = 10;     // on each side of a page, what the printer does not reach
  bool interior = false;  // also the edges inside; of an SVG or PDF in one piece
  // Nothing besides the lines: no colours of strain, legend, caption or names; of an SVG or PDF in one
  // piece. Others have no colours anyway.
  bool plain = false;

  bool operator==(const DrawingOptions&) const = default;
};

// Triangles from this one on, up to that of the next part, are of an object or group of this name.
struct NamedPart {
  std::uint32_t first_triangle = 0;
  std::string name;  // empty: none

  bool operator==(const NamedPart&) const = default;
};

struct DrawingFile {
  std::string page;  // "cover", or the number of the page; empty when it is not one of several
  std::string bytes;

  bool operator==(const DrawingFile&) const = default;
};

// What one DrawingOptions has led to.
struct Drawing {
  std::vector<DrawingFile> files;  // one; of an SVG on paper the cover, then the pages
  std::vector<Warning> warnings;   // their elements are pieces, by chart
};

}  // namespace arap
