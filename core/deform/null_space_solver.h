// The null-space form: the mesh's grounded factors, one response per row, one small dense system
// per step [algorithm §2]. Step 1 needs no sparse solve at all per frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/registered_parts.h"

namespace arap {

// Z = G Cᴴ: how the grounded mesh answers each constraint row. One back-substitution a row, reused
// by every edit that keeps the row. Copies share their columns.
class Responses {
 public:
  // How the mesh answers one row, per vertex (#V each): in step 1, split in real and imaginary
  // parts so that adding one is a plain loop, and in step 2.
  struct Column {
    std::vector<double> similarity_real, similarity_imag, rigid;
  };

  std::size_t rows() const { return columns_.size(); }
  // Shared columns count in full.
  std::size_t bytes() const;

  const Column& of(std::size_t row) const { return *columns_[row]; }

  // Those of the given rows only.
  Responses Select(const std::vector<std::size_t>& rows) const;

  // Appends the responses of `added`. Asks `cancel` between blocks of columns.
  Status Append(const RegisteredMeshParts& mesh, const std::vector<Row>& added,
                const CancelToken& cancel);

 private:
  std::vector<std::shared_ptr<const Column>> columns_;
};

class NullSpaceSolver : public ConstraintSolver {
 public:
  // `parts` comes with rows, roles and responses. O(k³) for k active rows.
  explicit NullSpaceSolver(const CompiledHandlesParts& parts);

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
  const RegisteredMeshParts* mesh_;  // kept alive by the handle set that owns this
  std::shared_ptr<const Responses> responses_;
  std::vector<Row> rows_;             // active
  std::vector<std::size_t> columns_;  // of each active row in the responses
  std::vector<std::uint32_t> slot_;   // per component: its place in the null space, or kNone
  Saddle<Complex> similarity_;        // null space per component: 1 and p − centre
  Saddle<double> rigid_;              // null space per component: 1
};

}  // namespace arap
