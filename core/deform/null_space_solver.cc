#include "core/deform/null_space_solver.h"

#include <algorithm>

#include "core/base/try.h"
#include "core/base/wide.h"
#include "core/deform/vertex_runs.h"

namespace arap {
namespace {

// Columns solved together: as many as the factors take at once, and few to be cancelled between.
constexpr std::size_t kSolvedTogether = 4;

// Calls store(row, solution) for G applied to every row.
template <class Scalar, class Store>
Status SolveRows(const Factor<Scalar>& factor, const std::vector<Row>& rows,
                 const std::vector<std::uint32_t>& grounded, const CancelToken& cancel,
                 Store store) {
  const std::size_t n = factor.size();
  Workspace workspace;
  std::vector<Scalar> right;
  for (std::size_t begin = 0; begin < rows.size(); begin += kSolvedTogether) {
    CHECK_OK(cancel.Check());
    const std::size_t count = std::min(kSolvedTogether, rows.size() - begin);
    right.assign(n * count, Scalar(0));
    for (std::size_t j = 0; j < count; ++j) {
      const Row& row = rows[begin + j];
      for (std::size_t k = 0; k < 3; ++k) right[j * n + row.vertex[k]] += row.weight[k];
      for (const std::uint32_t v : grounded) right[j * n + v] = Scalar(0);
    }
    TRY(const auto z, factor.Solve(right, count, workspace));
    for (std::size_t j = 0; j < count; ++j) store(begin + j, z.subspan(j * n, n));
  }
  return {};
}

// How many columns are added up before the shape gets their sum.
constexpr std::size_t kColumnGroup = 4;

// One column (#V) and what it is multiplied with.
struct ScaledColumn {
  const double* values = nullptr;
  Complex factor;
};

// Adds groups of columns one after the other, in one pass over the shape.
template <std::size_t kGroups>
ARAP_WIDE_BODY void AddGroups(const ScaledColumn* c, std::size_t begin, std::size_t end,
                              double* shape) {
  constexpr std::size_t kColumns = kGroups * kColumnGroup;
  const double* z[kColumns];
  double fx[kColumns], fy[kColumns];
  for (std::size_t i = 0; i < kColumns; ++i) {
    z[i] = c[i].values;
    fx[i] = c[i].factor.real();
    fy[i] = c[i].factor.imag();
  }
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    double x = shape[2 * v], y = shape[2 * v + 1];
#pragma GCC unroll 2
    for (std::size_t i = 0; i < kColumns; i += kColumnGroup) {
      const double a0 = z[i][v], a1 = z[i + 1][v], a2 = z[i + 2][v], a3 = z[i + 3][v];
      x += (a0 * fx[i] + a1 * fx[i + 1]) + (a2 * fx[i + 2] + a3 * fx[i + 3]);
      y += (a0 * fy[i] + a1 * fy[i + 1]) + (a2 * fy[i + 2] + a3 * fy[i + 3]);
    }
    shape[2 * v] = x;
    shape[2 * v + 1] = y;
  }
}

void AddFour(const ScaledColumn* c, std::size_t begin, std::size_t end, double* shape) {
  AddGroups<1>(c, begin, end, shape);
}
void AddEight(const ScaledColumn* c, std::size_t begin, std::size_t end, double* shape) {
  AddGroups<2>(c, begin, end, shape);
}
ARAP_WIDE(AddGroups<1>, AddFourWide,
          (const ScaledColumn* c, std::size_t begin, std::size_t end, double* shape),
          (c, begin, end, shape))
ARAP_WIDE(AddGroups<2>, AddEightWide,
          (const ScaledColumn* c, std::size_t begin, std::size_t end, double* shape),
          (c, begin, end, shape))

// shape += Σ values·factor over the columns that `column_at(i)` makes, for vertices [from, to); block by
// block, so that the shape stays in a near cache and columns are read far ahead. Their order decides
// the rounding; where there are not four more, columns times 0 stand in.
template <class ColumnAt>
void AddColumns(std::size_t count, std::size_t from, std::size_t to, std::span<Complex> shape,
                ColumnAt column_at) {
  constexpr std::size_t kBlock = 4096;
  auto* numbers = reinterpret_cast<double*>(shape.data());
  for (std::size_t begin = from; begin < to; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, to);
    for (std::size_t i = 0; i < count;) {
      const bool eight = i + kColumnGroup < count;
      ScaledColumn columns[2 * kColumnGroup];
      const std::size_t last = i + (eight ? 2 : 1) * kColumnGroup;
      for (ScaledColumn* c = columns; i < last; ++i, ++c) {
        *c = i < count ? column_at(i) : ScaledColumn{columns[0].values, 0};
      }
      if (eight) {
        (HasWide() ? AddEightWide : AddEight)(columns, begin, end, numbers);
      } else {
        (HasWide() ? AddFourWide : AddFour)(columns, begin, end, numbers);
      }
    }
  }
}

// How many vertices a part has to which so many columns are added: some hundred microseconds' work.
std::size_t RangeOf(std::size_t columns) {
  constexpr std::size_t kUsual = 16;  // columns
  return std::max<std::size_t>(2'048, kVertexRange * kUsual / std::max(columns, kUsual));
}

}  // namespace

std::size_t Responses::bytes() const {
  std::size_t bytes = 0;
  for (const auto& column : columns_) bytes += column->rigid.size() * 3 * sizeof(double);
  return bytes;
}

Responses Responses::Select(const std::vector<std::size_t>& rows) const {
  Responses selected;
  for (const std::size_t row : rows) selected.columns_.push_back(columns_[row]);
  return selected;
}

Status Responses::Append(const RegisteredMeshParts& mesh, const std::vector<Row>& added,
                         const CancelToken& cancel) {
  std::vector<std::shared_ptr<Column>> columns;
  for (std::size_t j = 0; j < added.size(); ++j) columns.push_back(std::make_shared<Column>());

  std::vector<std::uint32_t> grounded;
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground0);
  CHECK_OK(SolveRows<double>(*mesh.rigid, added, grounded, cancel,
                             [&](std::size_t j, std::span<const double> z) {
                               columns[j]->rigid.assign(z.begin(), z.end());
                             }));
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground1);
  CHECK_OK(SolveRows<Complex>(*mesh.similarity, added, grounded, cancel,
                              [&](std::size_t j, std::span<const Complex> z) {
                                Column& column = *columns[j];
                                column.similarity_real.reserve(z.size());
                                column.similarity_imag.reserve(z.size());
                                for (const Complex x : z) {
                                  column.similarity_real.push_back(x.real());
                                  column.similarity_imag.push_back(x.imag());
                                }
                              }));
  columns_.insert(columns_.end(), columns.begin(), columns.end());
  return {};
}

NullSpaceSolver::NullSpaceSolver(const CompiledHandlesParts& parts)
    : mesh_(&parts.mesh->parts()), responses_(parts.responses), slot_(parts.roles.active_slot) {
  for (const std::size_t r : parts.roles.active_rows) {
    rows_.push_back(parts.rows[r]);
    columns_.push_back(r);
  }
  const auto k = static_cast<Eigen::Index>(rows_.size());
  const auto m = static_cast<Eigen::Index>(parts.roles.active_components);
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

Status NullSpaceSolver::AddSimilarity(std::span<const Complex> miss, std::span<Complex> shape,
                                      SolverScratch& scratch) const {
  const auto k = static_cast<Eigen::Index>(rows_.size());
  for (Eigen::Index i = 0; i < k; ++i) {
    scratch.similarity.right[i] = miss[static_cast<std::size_t>(i)];
  }
  similarity_.Solve(scratch.similarity);
  const auto& solution = scratch.similarity.solution;
  RunRanges(scratch.crew, shape.size(), RangeOf(2 * rows_.size()),
            [&](std::size_t begin, std::size_t end) {
              ForRunsIn(mesh_->runs, begin, end, [&](const VertexRun& run) {
                if (run.component == kNone || slot_[run.component] == kNone) return;
                const auto at = k + 2 * static_cast<Eigen::Index>(slot_[run.component]);
                AddSimilarityOf(
                    run, mesh_->rest,
                    {mesh_->components[run.component].center, solution[at], solution[at + 1]},
                    shape);
              });
              // λ z is λ times the real part, and iλ times the imaginary one.
              AddColumns(2 * rows_.size(), begin, end, shape, [&](std::size_t i) -> ScaledColumn {
                const Responses::Column& column = responses_->of(columns_[i / 2]);
                const Complex lambda = solution[static_cast<Eigen::Index>(i / 2)];
                if (i % 2 == 0) return {column.similarity_real.data(), lambda};
                return {column.similarity_imag.data(), Complex(-lambda.imag(), lambda.real())};
              });
            });
  return {};
}

const Factor<double>& NullSpaceSolver::rigid_factor() const { return *mesh_->rigid; }

bool NullSpaceSolver::NeedsRigidSolve(bool turned) const { return turned; }

void NullSpaceSolver::CompleteForce(std::span<const Complex>, std::span<Complex> force) const {
  for (const MeshComponent& c : mesh_->components) force[c.ground0] = 0;
}

Status NullSpaceSolver::AddRigid(std::span<const Complex> solution, std::span<const Complex> miss,
                                 std::span<Complex> shape, SolverScratch& scratch) const {
  const auto k = static_cast<Eigen::Index>(rows_.size());
  for (Eigen::Index i = 0; i < k; ++i) {
    Complex left = miss[static_cast<std::size_t>(i)];
    if (!solution.empty()) left -= PointOf(rows_[static_cast<std::size_t>(i)], solution);
    scratch.rigid_x.right[i] = left.real();
    scratch.rigid_y.right[i] = left.imag();
  }
  rigid_.Solve(scratch.rigid_x);
  rigid_.Solve(scratch.rigid_y);
  const auto &x = scratch.rigid_x.solution, &y = scratch.rigid_y.solution;
  RunRanges(scratch.crew, shape.size(), RangeOf(rows_.size()),
            [&](std::size_t begin, std::size_t end) {
              if (!solution.empty()) {
                AddShape(solution.subspan(begin, end - begin), shape.subspan(begin, end - begin));
              }
              AddColumns(rows_.size(), begin, end, shape, [&](std::size_t i) -> ScaledColumn {
                const auto row = static_cast<Eigen::Index>(i);
                return {responses_->of(columns_[i]).rigid.data(), {x[row], y[row]}};
              });
              ForRunsIn(mesh_->runs, begin, end, [&](const VertexRun& run) {
                if (run.component == kNone || slot_[run.component] == kNone) return;
                const auto at = k + static_cast<Eigen::Index>(slot_[run.component]);
                Shift(run, {x[at], y[at]}, shape);
              });
            });
  return {};
}

std::size_t NullSpaceSolver::bytes() const {
  const auto one = static_cast<std::size_t>(similarity_.size()),
             two = static_cast<std::size_t>(rigid_.size());
  return responses_->bytes() + 2 * (one * one * sizeof(Complex) + two * two * sizeof(double));
}

}  // namespace arap
