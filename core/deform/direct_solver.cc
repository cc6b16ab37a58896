#include "core/deform/direct_solver.h"

#include <algorithm>

#include "core/base/try.h"
#include "core/energy/assemble.h"

namespace arap {
namespace {

double MatrixWeight(const Row& row) { return row.compliance == 0 ? 1 : 1 / row.compliance; }

// `lower` + Σ weight · rowᵀ row, lower triangle.
template <class Scalar>
Eigen::SparseMatrix<Scalar> WithRows(const Eigen::SparseMatrix<Scalar>& lower,
                                     const std::vector<Row>& rows) {
  std::vector<Eigen::Triplet<Scalar, int>> triplets;
  for (const Row& row : rows) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        if (row.vertex[a] < row.vertex[b]) continue;
        const double value = MatrixWeight(row) * row.weight[a] * row.weight[b];
        if (value == 0) continue;
        triplets.emplace_back(static_cast<int>(row.vertex[a]), static_cast<int>(row.vertex[b]),
                              Scalar(value));
      }
    }
  }
  Eigen::SparseMatrix<Scalar> extra(lower.rows(), lower.cols());
  extra.setFromTriplets(triplets.begin(), triplets.end());
  return lower + extra;
}

// Responses of the hard rows to a factor, and their Schur complement.
template <class Scalar, class Matrix>
Status MakeSchur(const Factor<Scalar>& factor, const std::vector<Row>& rows,
                 const std::vector<std::size_t>& hard, Matrix& responses, Saddle<Scalar>& schur) {
  const std::size_t n = factor.size();
  const auto k = static_cast<Eigen::Index>(hard.size());
  Workspace workspace;
  std::vector<Scalar> right(n);
  responses.resize(static_cast<Eigen::Index>(n), k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const Row& row = rows[hard[static_cast<std::size_t>(j)]];
    std::fill(right.begin(), right.end(), Scalar(0));
    for (std::size_t c = 0; c < 3; ++c) right[row.vertex[c]] += row.weight[c];
    TRY(const auto z, factor.Solve(right, 1, workspace));
    std::copy(z.begin(), z.end(), responses.col(j).data());
  }
  typename Saddle<Scalar>::Matrix cz(k, k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const Row& row = rows[hard[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < k; ++j) {
      cz(i, j) = Scalar(0);
      for (std::size_t c = 0; c < 3; ++c) {
        cz(i, j) += row.weight[c] * responses(static_cast<Eigen::Index>(row.vertex[c]), j);
      }
    }
  }
  schur = Saddle<Scalar>(cz, typename Saddle<Scalar>::Matrix(k, 0));
  return {};
}

}  // namespace

Result<std::shared_ptr<const ConstraintSolver>> DirectSolver::Make(
    const CompiledHandlesParts& parts, const CancelToken& cancel) {
  std::shared_ptr<DirectSolver> solver(new DirectSolver());
  CHECK_OK(solver->FactorWith(parts, cancel));
  CHECK_OK(solver->AddHardRows());
  return std::shared_ptr<const ConstraintSolver>(std::move(solver));
}

Status DirectSolver::FactorWith(const CompiledHandlesParts& parts, const CancelToken& cancel) {
  mesh_ = &parts.mesh->parts();
  for (const std::size_t r : parts.roles.active_rows) {
    if (parts.rows[r].compliance == 0) hard_.push_back(rows_.size());
    rows_.push_back(parts.rows[r]);
  }
  fixed_.resize(mesh_->rest.size());
  for (std::size_t v = 0; v < fixed_.size(); ++v) {
    const std::uint32_t c = mesh_->topology.vertex_component[v];
    fixed_[v] = c == kNone || parts.roles.active_slot[c] == kNone;
  }
  CHECK_OK(cancel.Check());
  TRY(similarity_, Factor<Complex>::Make(WithRows(AssembleSimilarity(mesh_->cells, fixed_), rows_),
                                         FactorLayout::kPacked, mesh_->similarity->order()));
  CHECK_OK(cancel.Check());
  TRY(rigid_, Factor<double>::Make(WithRows(AssembleRigid(mesh_->cells, fixed_), rows_),
                                   FactorLayout::kPacked, mesh_->rigid->order()));
  return cancel.Check();
}

Status DirectSolver::AddHardRows() {
  CHECK_OK(MakeSchur(*similarity_, rows_, hard_, similarity_responses_, similarity_schur_));
  return MakeSchur(*rigid_, rows_, hard_, rigid_responses_, rigid_schur_);
}

void DirectSolver::Prepare(SolverScratch& scratch) const {
  scratch.complex_right.assign(mesh_->rest.size(), 0);
  scratch.similarity.Resize(similarity_schur_.size());
  scratch.rigid_x.Resize(rigid_schur_.size());
  scratch.rigid_y.Resize(rigid_schur_.size());
}

Status DirectSolver::AddSimilarity(std::span<const Complex> miss, ShapeView shape,
                                   SolverScratch& scratch) const {
  const std::size_t n = mesh_->rest.size();
  std::fill(scratch.complex_right.begin(), scratch.complex_right.end(), Complex(0));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      scratch.complex_right[rows_[i].vertex[c]] +=
          MatrixWeight(rows_[i]) * rows_[i].weight[c] * miss[i];
    }
  }
  TRY(const auto y, similarity_->Solve(scratch.complex_right, 1, scratch.workspace));
  for (std::size_t v = 0; v < n; ++v) {
    shape.x[v] += y[v].real();
    shape.y[v] += y[v].imag();
  }
  for (std::size_t j = 0; j < hard_.size(); ++j) {
    const Row& row = rows_[hard_[j]];
    Complex left = miss[hard_[j]];
    for (std::size_t c = 0; c < 3; ++c) left -= row.weight[c] * y[row.vertex[c]];
    scratch.similarity.right[static_cast<Eigen::Index>(j)] = left;
  }
  similarity_schur_.Solve(scratch.similarity);
  for (std::size_t j = 0; j < hard_.size(); ++j) {
    const Complex mu = scratch.similarity.solution[static_cast<Eigen::Index>(j)];
    const Complex* z = similarity_responses_.col(static_cast<Eigen::Index>(j)).data();
    for (std::size_t v = 0; v < n; ++v) {
      const Complex p = mu * z[v];
      shape.x[v] += p.real();
      shape.y[v] += p.imag();
    }
  }
  return {};
}

const Factor<double>& DirectSolver::rigid_factor() const { return *rigid_; }

bool DirectSolver::NeedsRigidSolve(bool) const { return true; }

void DirectSolver::CompleteForce(std::span<const Complex> miss, std::span<double> force) const {
  const std::size_t n = mesh_->rest.size();
  for (std::size_t v = 0; v < n; ++v) {
    if (fixed_[v]) force[v] = force[n + v] = 0;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = MatrixWeight(rows_[i]) * rows_[i].weight[c];
      force[rows_[i].vertex[c]] += weight * miss[i].real();
      force[n + rows_[i].vertex[c]] += weight * miss[i].imag();
    }
  }
}

void DirectSolver::AddRigid(const double* solution, std::span<const Complex> miss, ShapeView shape,
                            SolverScratch& scratch) const {
  const std::size_t n = mesh_->rest.size();
  for (std::size_t v = 0; v < n; ++v) shape.x[v] += solution[v];
  for (std::size_t v = 0; v < n; ++v) shape.y[v] += solution[n + v];
  for (std::size_t j = 0; j < hard_.size(); ++j) {
    const Complex left = miss[hard_[j]] - PointOf(rows_[hard_[j]], {solution, solution + n});
    scratch.rigid_x.right[static_cast<Eigen::Index>(j)] = left.real();
    scratch.rigid_y.right[static_cast<Eigen::Index>(j)] = left.imag();
  }
  rigid_schur_.Solve(scratch.rigid_x);
  rigid_schur_.Solve(scratch.rigid_y);
  for (std::size_t j = 0; j < hard_.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const double* z = rigid_responses_.col(at).data();
    const double mx = scratch.rigid_x.solution[at], my = scratch.rigid_y.solution[at];
    for (std::size_t v = 0; v < n; ++v) shape.x[v] += mx * z[v];
    for (std::size_t v = 0; v < n; ++v) shape.y[v] += my * z[v];
  }
}

std::size_t DirectSolver::bytes() const {
  return similarity_->bytes() + rigid_->bytes() +
         static_cast<std::size_t>(rigid_responses_.size()) * 3 * sizeof(double);
}

}  // namespace arap
