#include "core/deform/null_space_solver.h"

#include "core/deform/columns.h"
#include "core/deform/compiled_parts.h"

namespace arap {

NullSpaceSolver::NullSpaceSolver(const CompiledHandlesParts& parts)
    : mesh_(&parts.mesh->parts()), responses_(parts.responses), slot_(parts.active_slot) {
  for (const std::size_t r : parts.active_rows) {
    rows_.push_back(parts.rows[r]);
    columns_.push_back(r);
  }
  const auto k = static_cast<Eigen::Index>(rows_.size());
  const auto m = static_cast<Eigen::Index>(parts.active_components);
  Eigen::MatrixXcd cz1(k, k), cn1 = Eigen::MatrixXcd::Zero(k, 2 * m);
  Eigen::MatrixXd cz2(k, k), cn2 = Eigen::MatrixXd::Zero(k, m);
  for (Eigen::Index i = 0; i < k; ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < k; ++j) {
      const Responses::Column& column = responses_->of(columns_[static_cast<std::size_t>(j)]);
      Complex z1 = 0;
      double z2 = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t v = row.vertex[c];
        z1 += row.weight[c] * Complex(column.similarity_real[v], column.similarity_imag[v]);
        z2 += row.weight[c] * column.rigid[v];
      }
      cz1(i, j) = z1;
      cz2(i, j) = z2;
    }
    cz1(i, i) += row.compliance;
    cz2(i, i) += row.compliance;
    const auto slot = static_cast<Eigen::Index>(slot_[row.component]);
    cn1(i, 2 * slot) = 1;
    cn1(i, 2 * slot + 1) = row.rest - mesh_->components[row.component].center;
    cn2(i, slot) = 1;
  }
  similarity_ = Saddle<Complex>(cz1, cn1);
  rigid_ = Saddle<double>(cz2, cn2);
}

void NullSpaceSolver::Prepare(SolverScratch& scratch) const {
  scratch.similarity.Resize(similarity_.size());
  scratch.rigid_x.Resize(rigid_.size());
  scratch.rigid_y.Resize(rigid_.size());
}

bool NullSpaceSolver::AddSimilarity(std::span<const Complex> miss, ShapeView shape,
                                    SolverScratch& scratch) const {
  const auto k = static_cast<Eigen::Index>(rows_.size());
  for (Eigen::Index i = 0; i < k; ++i) {
    scratch.similarity.right[i] = miss[static_cast<std::size_t>(i)];
  }
  similarity_.Solve(scratch.similarity);
  const auto& solution = scratch.similarity.solution;
  const std::size_t n = mesh_->rest.size();
  for (std::size_t v = 0; v < n; ++v) {
    const std::uint32_t c = mesh_->topology.vertex_component[v];
    if (c == kNone || slot_[c] == kNone) continue;
    const auto at = k + 2 * static_cast<Eigen::Index>(slot_[c]);
    const Complex p =
        solution[at] + solution[at + 1] * (mesh_->rest[v] - mesh_->components[c].center);
    shape.x[v] += p.real();
    shape.y[v] += p.imag();
  }
  AddColumns(2 * rows_.size(), n, shape, [&](std::size_t i) -> ScaledColumn {
    const Responses::Column& column = responses_->of(columns_[i / 2]);
    const Complex lambda = solution[static_cast<Eigen::Index>(i / 2)];
    if (i % 2 == 0) return {column.similarity_real.data(), lambda};
    return {column.similarity_imag.data(), Complex(-lambda.imag(), lambda.real())};
  });
  return true;
}

const Factor<double>& NullSpaceSolver::rigid_factor() const { return *mesh_->rigid; }

bool NullSpaceSolver::NeedsRigidSolve(bool turned) const { return turned; }

void NullSpaceSolver::CompleteForce(std::span<const Complex>, std::span<double> force) const {
  const std::size_t n = mesh_->rest.size();
  for (const MeshComponent& c : mesh_->components) force[c.ground0] = force[n + c.ground0] = 0;
}

void NullSpaceSolver::AddRigid(const double* solution, std::span<const Complex> miss,
                               ShapeView shape, SolverScratch& scratch) const {
  const std::size_t n = mesh_->rest.size();
  const auto k = static_cast<Eigen::Index>(rows_.size());
  for (Eigen::Index i = 0; i < k; ++i) {
    Complex left = miss[static_cast<std::size_t>(i)];
    if (solution) left -= PointOf(rows_[static_cast<std::size_t>(i)], {solution, solution + n});
    scratch.rigid_x.right[i] = left.real();
    scratch.rigid_y.right[i] = left.imag();
  }
  if (solution) {
    for (std::size_t v = 0; v < n; ++v) shape.x[v] += solution[v];
    for (std::size_t v = 0; v < n; ++v) shape.y[v] += solution[n + v];
  }
  rigid_.Solve(scratch.rigid_x);
  rigid_.Solve(scratch.rigid_y);
  const auto &x = scratch.rigid_x.solution, &y = scratch.rigid_y.solution;
  AddColumns(rows_.size(), n, shape, [&](std::size_t i) -> ScaledColumn {
    const auto row = static_cast<Eigen::Index>(i);
    return {responses_->of(columns_[i]).rigid.data(), {x[row], y[row]}};
  });
  for (std::size_t v = 0; v < n; ++v) {
    const std::uint32_t c = mesh_->topology.vertex_component[v];
    if (c == kNone || slot_[c] == kNone) continue;
    const auto at = k + static_cast<Eigen::Index>(slot_[c]);
    shape.x[v] += x[at];
    shape.y[v] += y[at];
  }
}

std::size_t NullSpaceSolver::bytes() const {
  const auto one = static_cast<std::size_t>(similarity_.size()),
             two = static_cast<std::size_t>(rigid_.size());
  return responses_->bytes() + 2 * (one * one * sizeof(Complex) + two * two * sizeof(double));
}

}  // namespace arap
