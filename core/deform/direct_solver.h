// The direct form: mesh and handles factored together, as the paper compiles [II09 §6]. For many
// rows: nothing grows with their number but the right-hand side. An edit factors again.
//
// Soft rows enter the matrix with their weights. Hard rows enter with weight 1, which costs nothing
// where they are met, and are then met exactly by a small Schur complement.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/LU>

#include "arap/base/cancel.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/registered_parts.h"

namespace arap {

class DirectSolver : public ConstraintSolver {
 public:
  // `parts` comes with rows and roles. O(n^1.5) like a registration.
  static Result<std::shared_ptr<const ConstraintSolver>> Make(const CompiledHandlesParts& parts,
                                                              const CancelToken& cancel);

  void Prepare(SolverScratch& scratch) const override;
  Status AddSimilarity(std::span<const Complex> miss, ShapeView shape,
                       SolverScratch& scratch) const override;
  const Factor<double>& rigid_factor() const override;
  bool NeedsRigidSolve(bool turned) const override;
  void CompleteForce(std::span<const Complex> miss, std::span<double> force) const override;
  void AddRigid(const double* solution, std::span<const Complex> miss, ShapeView shape,
                SolverScratch& scratch) const override;
  std::size_t bytes() const override;

 private:
  DirectSolver() = default;
  Status FactorWith(const CompiledHandlesParts& parts, const CancelToken& cancel);
  Status AddHardRows();

  const RegisteredMeshParts* mesh_ = nullptr;  // kept alive by the handle set that owns this
  std::vector<Row> rows_;                      // active
  std::vector<std::size_t> hard_;              // which of them are hard
  std::vector<bool> fixed_;                    // vertices outside active components
  std::shared_ptr<const Factor<Complex>> similarity_;
  std::shared_ptr<const Factor<double>> rigid_;
  Eigen::MatrixXcd similarity_responses_;  // #V×#hard
  Eigen::MatrixXd rigid_responses_;        // #V×#hard
  Saddle<Complex> similarity_schur_;       // without a null space
  Saddle<double> rigid_schur_;
};

}  // namespace arap
