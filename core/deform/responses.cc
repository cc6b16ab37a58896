#include "core/deform/responses.h"

#include <algorithm>

namespace arap {
namespace {

// Columns solved together: as many as the factors take at once, and few to be cancelled between.
constexpr std::size_t kBlock = 4;

// Calls store(row, solution) for G applied to every row.
template <class Scalar, class Store>
Status SolveRows(const Factor<Scalar>& factor, const std::vector<Row>& rows,
                 const std::vector<std::uint32_t>& grounded, const CancelToken& cancel,
                 Store store) {
  const std::size_t n = factor.size();
  Workspace workspace;
  std::vector<Scalar> right;
  for (std::size_t begin = 0; begin < rows.size(); begin += kBlock) {
    if (auto ok = cancel.Check(); !ok) return ok;
    const std::size_t count = std::min(kBlock, rows.size() - begin);
    right.assign(n * count, Scalar(0));
    for (std::size_t j = 0; j < count; ++j) {
      const Row& row = rows[begin + j];
      for (std::size_t k = 0; k < 3; ++k) right[j * n + row.vertex[k]] += row.weight[k];
      for (const std::uint32_t v : grounded) right[j * n + v] = Scalar(0);
    }
    const std::span<const Scalar> z = factor.Solve(right, count, workspace);
    if (z.empty()) return Fail(FaultKind::kNumerical, "a back-substitution ran out of memory");
    for (std::size_t j = 0; j < count; ++j) store(begin + j, z.subspan(j * n, n));
  }
  return {};
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
  auto ok = SolveRows<double>(*mesh.rigid, added, grounded, cancel,
                              [&](std::size_t j, std::span<const double> z) {
                                columns[j]->rigid.assign(z.begin(), z.end());
                              });
  if (!ok) return ok;
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground1);
  ok = SolveRows<Complex>(*mesh.similarity, added, grounded, cancel,
                          [&](std::size_t j, std::span<const Complex> z) {
                            Column& column = *columns[j];
                            column.similarity_real.reserve(z.size());
                            column.similarity_imag.reserve(z.size());
                            for (const Complex x : z) {
                              column.similarity_real.push_back(x.real());
                              column.similarity_imag.push_back(x.imag());
                            }
                          });
  if (!ok) return ok;
  columns_.insert(columns_.end(), columns.begin(), columns.end());
  return {};
}

}  // namespace arap
