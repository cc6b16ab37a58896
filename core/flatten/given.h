// Given: between the surface that was mended, which is laid flat, and the one that was given.
#pragma once

#include "arap/model/flatten.h"
#include "core/mesh/repair.h"

namespace arap {

// Options whose pins and grain lines name vertices that stand for themselves, and whose rigidity is that
// of the mended triangles. Seams are the cutter's to translate. `repair` has changed something.
FlattenOptions OfMended(FlattenOptions options, const Repair& repair);

// A layout of the mended surface made one of the given vertices and triangles:
//   corners of a triangle have the positions of its parts, or of the one that was kept in its place;
//   singular values are those of its worst part; a chart counts the given triangles that are on it;
//   what collapsed counts as left out, on the chart of its corner;
//   a vertex that another stands for lies where its lowest triangle has it; `welded` says which.
// "torn_triangles" warns of given triangles whose parts were cut apart: their corners name one side.
// O(#V + #F log #F).
void OfGiven(const Repair& repair, Flattening& flat);

}  // namespace arap
