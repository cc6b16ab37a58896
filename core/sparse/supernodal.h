// The numbers of a supernodal Cholesky factor, for a pattern that CHOLMOD has analysed.
//
// Left-looking, supernode by supernode, as CHOLMOD does it too. A mesh of 10,000 vertices has thousands of supernodes of
// a few columns, where calls of BLAS and OpenMP's regions cost more than the sums. Here a product is one loop that keeps
// its sums in registers; it is as fast as BLAS on large ones too, as far as meshes have them. A complex column counts as
// two real rows that lie side by side, so that both kinds of factors share the loop.
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/SparseCore>

#include "core/sparse/block_products.h"

namespace arap {

// Where supernode s has its columns first[s]…first[s + 1]−1, its rows rows[rows_begin[s]]…, of which its own columns
// are the first, and its dense block values_begin[s]…, column by column.
struct SupernodalPattern {
  std::span<const int> first, rows_begin, rows, values_begin;
  std::span<const int> order;  // row k of the factor is row order[k] of the matrix
};

// Writes the blocks of L of P A Pᵀ = L Lᴴ to `values`, where A has the lower triangle `lower` and a pattern inside
// the analysed one; above the diagonals of the blocks stands nothing of use. Returns whether A is positive definite;
// if not, the numbers are of no use. Scalar is double or std::complex<double>. Throws std::bad_alloc.
template <class Scalar>
bool FactorSupernodes(const SupernodalPattern& pattern, const Eigen::SparseMatrix<Scalar>& lower,
                      Scalar* values, ProductCode code = BestProductCode());

}  // namespace arap
