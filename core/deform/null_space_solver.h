// The null-space form: the mesh's grounded factors, one response per row, one small dense system
// per step [algorithm §4]. Step 1 needs no sparse solve at all per frame.
#pragma once

#include <memory>
#include <vector>

#include "core/deform/constraint_solver.h"
#include "core/deform/responses.h"

namespace arap {

struct CompiledHandlesParts;

class NullSpaceSolver : public ConstraintSolver {
 public:
  // `parts` comes with rows, roles and responses. O(k³) for k active rows.
  explicit NullSpaceSolver(const CompiledHandlesParts& parts);

  void Prepare(SolverScratch& scratch) const override;
  bool AddSimilarity(std::span<const Complex> miss, ShapeView shape,
                     SolverScratch& scratch) const override;
  const Factor<double>& rigid_factor() const override;
  bool NeedsRigidSolve(bool turned) const override;
  void CompleteForce(std::span<const Complex> miss, std::span<double> force) const override;
  void AddRigid(const double* solution, std::span<const Complex> miss, ShapeView shape,
                SolverScratch& scratch) const override;
  std::size_t bytes() const override;

 private:
  const RegisteredMeshParts* mesh_;  // kept alive by the handle set that owns this
  std::shared_ptr<const Responses> responses_;
  std::vector<Row> rows_;             // active
  std::vector<std::size_t> columns_;  // of each active row in the responses
  std::vector<std::uint32_t> slot_;   // per component: its place in the null space, or kNone
  Saddle<Complex> similarity_;        // null space per component: 1 and p − centre
  Saddle<double> rigid_;              // null space per component: 1
};

}  // namespace arap
