// The direct form: mesh and handles factored together, as the paper compiles [II09 §6]. For many
// rows: nothing grows with their number but the right-hand side. An edit factors again.
//
// Soft rows enter the matrix with their weights. A hard row on a single vertex takes that vertex out
// of the unknowns: an area handle costs less for every vertex that it holds. Other hard rows enter
// with weight 1, which costs nothing where they are met, and are then met exactly by a small Schur
// complement and a second solve.
#pragma once

#include <memory>
#include <vector>

#include "arap/base/cancel.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/registered_parts.h"

namespace arap {

class DirectSolver : public ConstraintSolver {
 public:
  // `parts` comes with rows and roles. O(n^1.5) like a registration, and O(n·h + h³) for h active
  // hard rows inside triangles. Faults: those of a factorisation, of `cancel`.
  static Result<std::shared_ptr<const ConstraintSolver>> Make(const CompiledHandlesParts& parts,
                                                              const CancelToken& cancel);

  void Prepare(SolverScratch& scratch) const override;
  Status AddSimilarity(std::span<const Complex> miss, std::span<Complex> shape,
                       SolverScratch& scratch) const override;
  const Factor<double>& rigid_factor() const override;
  bool NeedsRigidSolve(bool turned) const override;
  void CompleteForce(std::span<const Complex> miss, std::span<Complex> force) const override;
  Status AddRigid(std::span<const Complex> solution, std::span<const Complex> miss,
                  std::span<Complex> shape, SolverScratch& scratch) const override;
  std::size_t bytes() const override;

 private:
  // An entry of a matrix between an unknown and a held vertex.
  template <class Scalar>
  struct Coupling {
    std::uint32_t free = 0, held = 0;
    Scalar value;
  };
  // One step: its matrix over the unknowns, factored.
  template <class Scalar>
  struct Step {
    std::vector<Coupling<Scalar>> couplings;
    std::shared_ptr<const Factor<Scalar>> factor;
    Saddle<Scalar> schur;  // of the hard rows inside triangles; without a null space
    std::size_t bytes() const;
  };

  DirectSolver() = default;
  void SortRows(const CompiledHandlesParts& parts);
  template <class Scalar>
  Status FactorStep(const Eigen::SparseMatrix<Scalar>& mesh_matrix, std::span<const int> order,
                    const CancelToken& cancel, Step<Scalar>& step) const;
  template <class Scalar>
  Status MakeSchur(const CancelToken& cancel, Step<Scalar>& step) const;

  const RegisteredMeshParts* mesh_ = nullptr;  // kept alive by the handle set that owns this
  std::vector<Row> rows_;                      // active
  std::vector<std::size_t> holding_;           // which of them hold a vertex
  std::vector<std::size_t> inside_;            // which of them are hard inside a triangle
  std::vector<bool> outside_;                  // vertices of components that are not active
  std::vector<bool> held_;                     // vertices that a row holds
  Step<Complex> similarity_;
  Step<double> rigid_;
};

}  // namespace arap
