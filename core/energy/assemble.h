// The two step matrices of a set of cells, and what goes with them frame by frame [algorithm §1].
#pragma once

#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "core/energy/cells.h"

namespace arap {

// Step 1, Hermitian: the energy of vᴴ H v with every t_c a linear function of v. Only the lower
// triangle is stored, #V×#V. Rows and columns of `fixed` vertices are those of the identity;
// `fixed` (#V) also marks vertices that no cell touches. Diagonal entries are exactly real (CHOLMOD
// insists).
Eigen::SparseMatrix<Complex> AssembleSimilarity(const Cells& cells, const std::vector<bool>& fixed);

// Step 2, the Laplacian of the energy edges; stored and fixed alike.
Eigen::SparseMatrix<double> AssembleRigid(const Cells& cells, const std::vector<bool>& fixed);

// The step-1 energy xᴴ H x of a shape (#V) and H x, half its gradient. From the residuals of the
// cells: the energy of a shape that is almost exact keeps its digits.
struct SimilarityForce {
  double energy = 0;
  std::vector<Complex> force;  // #V
};
SimilarityForce SimilarityForceAt(const Cells& cells, std::span<const Complex> shape);

}  // namespace arap
