// Nested dissection of a mesh of which it is known where the vertices are. For this folder only.
//
// Minimum degree (AMD) looks one vertex ahead. On a compact mesh of 100,000 vertices, such as a square, the factor that it
// leaves takes nearly twice the operations of one whose order halves the mesh again and again: first all that is inside of
// the parts, then the vertices that keep these apart, those of the first cut last. Parts are cut across their longer side in
// the middle; no partitioner of graphs is needed, which would take longer than the factor.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace arap {

// The lower triangle of a symmetric pattern, column by column: rows[begin[c]]…
struct LowerPattern {
  std::span<const int> begin, rows;
};

// When each vertex is eliminated (#n): 0 inside of the parts, up to the highest for the first cut. `points` (#n) says
// where they are. Ties are broken by the number of the vertex: the same bytes everywhere. O(n log n).
std::vector<int> DissectionStages(const LowerPattern& lower,
                                  std::span<const std::complex<double>> points);

}  // namespace arap
