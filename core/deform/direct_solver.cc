#include "core/deform/direct_solver.h"

#include <algorithm>

#include "core/base/try.h"
#include "core/deform/vertex_runs.h"
#include "core/energy/assemble.h"

namespace arap {
namespace {

// Columns solved together: as many as the factors take at once, and few to be cancelled between.
constexpr Eigen::Index kSolvedTogether = 4;

double MatrixWeight(const Row& row) { return row.compliance == 0 ? 1 : 1 / row.compliance; }

// `lower` + Σ weight · rowᵀ row over the rows that are not `left_out`, lower triangle.
template <class Scalar>
Eigen::SparseMatrix<Scalar> WithRows(const Eigen::SparseMatrix<Scalar>& lower,
                                     const std::vector<Row>& rows,
                                     const std::vector<std::size_t>& left_out) {
  std::vector<Eigen::Triplet<Scalar, int>> triplets;
  auto next = left_out.begin();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (next != left_out.end() && *next == i) {
      ++next;
      continue;
    }
    const Row& row = rows[i];
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

}  // namespace

Result<std::shared_ptr<const ConstraintSolver>> DirectSolver::Make(
    const CompiledHandlesParts& parts, const CancelToken& cancel) {
  std::shared_ptr<DirectSolver> solver(new DirectSolver());
  solver->SortRows(parts);
  const RegisteredMeshParts& mesh = parts.mesh->parts();
  CHECK_OK(cancel.Check());
  CHECK_OK(solver->FactorStep(AssembleSimilarity(mesh.cells, solver->outside_),
                              mesh.similarity->order(), cancel, solver->similarity_));
  CHECK_OK(solver->FactorStep(AssembleRigid(mesh.cells, solver->outside_), mesh.rigid->order(),
                              cancel, solver->rigid_));
  return std::shared_ptr<const ConstraintSolver>(std::move(solver));
}

void DirectSolver::SortRows(const CompiledHandlesParts& parts) {
  mesh_ = &parts.mesh->parts();
  const std::size_t n = mesh_->rest.size();
  held_.resize(n);
  for (const std::size_t r : parts.roles.active_rows) {
    const Row& row = parts.rows[r];
    const std::uint32_t vertex = row.single_vertex();
    if (row.compliance == 0) {
      (vertex == kNone ? inside_ : holding_).push_back(rows_.size());
      if (vertex != kNone) held_[vertex] = true;
    }
    rows_.push_back(row);
  }
  outside_.resize(n);
  for (std::size_t v = 0; v < n; ++v) {
    const std::uint32_t c = mesh_->topology.vertex_component[v];
    outside_[v] = c == kNone || parts.roles.active_slot[c] == kNone;
  }
}

template <class Scalar>
Status DirectSolver::FactorStep(const Eigen::SparseMatrix<Scalar>& mesh_matrix,
                                std::span<const int> order, const CancelToken& cancel,
                                Step<Scalar>& step) const {
  Eigen::SparseMatrix<Scalar> matrix = WithRows(mesh_matrix, rows_, holding_);
  if (!holding_.empty()) {
    for (int j = 0; j < matrix.outerSize(); ++j) {
      for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(matrix, j); it; ++it) {
        const auto row = static_cast<std::uint32_t>(it.row()),
                   column = static_cast<std::uint32_t>(j);
        if (!held_[row] && !held_[column]) continue;
        if (!held_[row]) step.couplings.push_back({row, column, it.value()});
        if (!held_[column]) {
          step.couplings.push_back({column, row, Eigen::numext::conj(it.value())});
        }
        it.valueRef() = Scalar(row == column ? 1 : 0);
      }
    }
    matrix.prune([](int, int, const Scalar& value) { return value != Scalar(0); });
    step.couplings.shrink_to_fit();
  }
  CHECK_OK(cancel.Check());
  TRY(step.factor, Factor<Scalar>::Make(matrix, FactorLayout::kPacked, order));
  return MakeSchur(cancel, step);
}

// C A⁻¹ Cᵀ over the unknowns, for the hard rows inside triangles.
template <class Scalar>
Status DirectSolver::MakeSchur(const CancelToken& cancel, Step<Scalar>& step) const {
  const auto k = static_cast<Eigen::Index>(inside_.size());
  const std::size_t n = mesh_->rest.size();
  Workspace workspace;
  std::vector<Scalar> right;
  typename Saddle<Scalar>::Matrix cz(k, k);
  for (Eigen::Index begin = 0; begin < k; begin += kSolvedTogether) {
    CHECK_OK(cancel.Check());
    const auto count = static_cast<std::size_t>(std::min(kSolvedTogether, k - begin));
    right.assign(n * count, Scalar(0));
    for (std::size_t j = 0; j < count; ++j) {
      const Row& row = rows_[inside_[static_cast<std::size_t>(begin) + j]];
      for (std::size_t c = 0; c < 3; ++c) {
        if (!held_[row.vertex[c]]) right[j * n + row.vertex[c]] += row.weight[c];
      }
    }
    TRY(const auto solved, step.factor->Solve(right, count, workspace));
    for (std::size_t j = 0; j < count; ++j) {
      const std::span<const Scalar> z = solved.subspan(j * n, n);
      for (Eigen::Index i = 0; i < k; ++i) {
        const Row& row = rows_[inside_[static_cast<std::size_t>(i)]];
        Scalar sum(0);
        for (std::size_t c = 0; c < 3; ++c) {
          if (!held_[row.vertex[c]]) sum += row.weight[c] * z[row.vertex[c]];
        }
        cz(i, begin + static_cast<Eigen::Index>(j)) = sum;
      }
    }
  }
  CHECK_OK(cancel.Check());
  step.schur = Saddle<Scalar>(cz, typename Saddle<Scalar>::Matrix(k, 0));
  return cancel.Check();
}

void DirectSolver::Prepare(SolverScratch& scratch) const {
  scratch.complex_right.assign(mesh_->rest.size(), 0);
  scratch.similarity.Resize(similarity_.schur.size());
  scratch.rigid_x.Resize(rigid_.schur.size());
  scratch.rigid_y.Resize(rigid_.schur.size());
}

Status DirectSolver::AddSimilarity(std::span<const Complex> miss, std::span<Complex> shape,
                                   SolverScratch& scratch) const {
  std::vector<Complex>& right = scratch.complex_right;
  std::fill(right.begin(), right.end(), Complex(0));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = rows_[i].vertex[c];
      if (!held_[v]) right[v] += MatrixWeight(rows_[i]) * rows_[i].weight[c] * miss[i];
    }
  }
  for (const std::size_t i : holding_) right[rows_[i].single_vertex()] = miss[i];
  for (const auto& c : similarity_.couplings) right[c.free] -= c.value * right[c.held];
  TRY(const auto y, similarity_.factor->Solve(right, 1, scratch.workspace, scratch.crew));
  AddShape(y, shape);
  if (inside_.empty()) return {};

  for (std::size_t j = 0; j < inside_.size(); ++j) {
    const Row& row = rows_[inside_[j]];
    Complex left = miss[inside_[j]];
    for (std::size_t c = 0; c < 3; ++c) left -= row.weight[c] * y[row.vertex[c]];
    scratch.similarity.right[static_cast<Eigen::Index>(j)] = left;
  }
  similarity_.schur.Solve(scratch.similarity);
  std::fill(right.begin(), right.end(), Complex(0));
  for (std::size_t j = 0; j < inside_.size(); ++j) {
    const Row& row = rows_[inside_[j]];
    const Complex mu = scratch.similarity.solution[static_cast<Eigen::Index>(j)];
    for (std::size_t c = 0; c < 3; ++c) {
      if (!held_[row.vertex[c]]) right[row.vertex[c]] += row.weight[c] * mu;
    }
  }
  TRY(const auto z, similarity_.factor->Solve(right, 1, scratch.workspace, scratch.crew));
  AddShape(z, shape);
  return {};
}

const Factor<double>& DirectSolver::rigid_factor() const { return *rigid_.factor; }

bool DirectSolver::NeedsRigidSolve(bool) const { return true; }

void DirectSolver::CompleteForce(std::span<const Complex> miss, std::span<Complex> force) const {
  for (std::size_t v = 0; v < force.size(); ++v) {
    if (outside_[v]) force[v] = 0;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      force[rows_[i].vertex[c]] += MatrixWeight(rows_[i]) * rows_[i].weight[c] * miss[i];
    }
  }
  for (const std::size_t i : holding_) force[rows_[i].single_vertex()] = miss[i];
  for (const auto& c : rigid_.couplings) force[c.free] -= c.value * force[c.held];
}

Status DirectSolver::AddRigid(std::span<const Complex> solution, std::span<const Complex> miss,
                              std::span<Complex> shape, SolverScratch& scratch) const {
  AddShape(solution, shape);
  if (inside_.empty()) return {};

  for (std::size_t j = 0; j < inside_.size(); ++j) {
    const Complex left = miss[inside_[j]] - PointOf(rows_[inside_[j]], solution);
    scratch.rigid_x.right[static_cast<Eigen::Index>(j)] = left.real();
    scratch.rigid_y.right[static_cast<Eigen::Index>(j)] = left.imag();
  }
  rigid_.schur.Solve(scratch.rigid_x);
  rigid_.schur.Solve(scratch.rigid_y);
  std::vector<Complex>& right = scratch.complex_right;
  std::fill(right.begin(), right.end(), Complex(0));
  for (std::size_t j = 0; j < inside_.size(); ++j) {
    const Row& row = rows_[inside_[j]];
    const auto at = static_cast<Eigen::Index>(j);
    const Complex mu(scratch.rigid_x.solution[at], scratch.rigid_y.solution[at]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (!held_[row.vertex[c]]) right[row.vertex[c]] += row.weight[c] * mu;
    }
  }
  // Not the workspace of `solution`, which other frames still read.
  AddShape(rigid_.factor->SolvePoints(right, 1, scratch.correction, scratch.crew), shape);
  return {};
}

template <class Scalar>
std::size_t DirectSolver::Step<Scalar>::bytes() const {
  const auto k = static_cast<std::size_t>(schur.size());
  return factor->bytes() + couplings.capacity() * sizeof(Coupling<Scalar>) +
         2 * k * k * sizeof(Scalar);
}

std::size_t DirectSolver::bytes() const {
  return similarity_.bytes() + rigid_.bytes() + rows_.size() * sizeof(Row) +
         (held_.size() + outside_.size()) / 8;
}

}  // namespace arap
