// In which order unknowns are eliminated, so that the factor stays small.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/base/result.h"

namespace arap {

// An order of elimination with little fill for a symmetric pattern, of which `lower` (#n×#n) has
// the lower triangle; values play no part. It also serves matrices with fewer numbers. Faults:
// kOutOfMemory, kMeshTooLarge.
template <class Scalar>
Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<Scalar>& lower);

// The same for the matrix of a mesh whose vertices (#n) lie at `points`: it is halved again and again (dissection.h). Less
// fill than above where the mesh is large and compact, such as a square of 100,000 vertices; more where it is slender.
template <class Scalar>
Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<Scalar>& lower,
                                          std::span<const std::complex<double>> points);

}  // namespace arap
