#include "core/deform/responses.h"

#include <algorithm>

namespace arap {
namespace {

// Columns solved together: enough for BLAS-3, few enough to stay in cache and to be cancelled
// between.
constexpr std::size_t kBlock = 32;

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
  return static_cast<std::size_t>(rigid_.size()) * 3 * sizeof(double);
}

Responses Responses::Select(const std::vector<Eigen::Index>& columns) const {
  Responses selected;
  selected.similarity_real_ = similarity_real_(Eigen::all, columns);
  selected.similarity_imag_ = similarity_imag_(Eigen::all, columns);
  selected.rigid_ = rigid_(Eigen::all, columns);
  return selected;
}

Status Responses::Append(const RegisteredMeshParts& mesh, const std::vector<Row>& added,
                         const CancelToken& cancel) {
  const std::size_t first = rows();
  const auto n = static_cast<Eigen::Index>(mesh.rest.size());
  const auto columns = static_cast<Eigen::Index>(first + added.size());
  similarity_real_.conservativeResize(n, columns);
  similarity_imag_.conservativeResize(n, columns);
  rigid_.conservativeResize(n, columns);

  std::vector<std::uint32_t> grounded;
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground0);
  auto ok = SolveRows<double>(
      *mesh.rigid, added, grounded, cancel, [&](std::size_t j, std::span<const double> z) {
        std::copy(z.begin(), z.end(), rigid_.col(static_cast<Eigen::Index>(first + j)).data());
      });
  if (!ok) return ok;
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground1);
  return SolveRows<Complex>(
      *mesh.similarity, added, grounded, cancel, [&](std::size_t j, std::span<const Complex> z) {
        const auto column = static_cast<Eigen::Index>(first + j);
        for (std::size_t v = 0; v < z.size(); ++v) {
          similarity_real_(static_cast<Eigen::Index>(v), column) = z[v].real();
          similarity_imag_(static_cast<Eigen::Index>(v), column) = z[v].imag();
        }
      });
}

}  // namespace arap
