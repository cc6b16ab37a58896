#include "core/deform/compiled_handles.h"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "core/deform/compiled_parts.h"
#include "core/deform/roles.h"

namespace arap {
namespace {

// Columns solved together: enough for BLAS-3, few enough to stay in cache and to be cancelled
// between.
constexpr std::size_t kBlock = 32;

template <class Scalar, class Store>
Status SolveColumns(const Factor<Scalar>& factor, const std::vector<Row>& rows,
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

// Z of `added`, written into the columns from `first_column` on.
Status FillColumns(CompiledHandlesParts& parts, const std::vector<Row>& added,
                   std::size_t first_column, const CancelToken& cancel) {
  const RegisteredMeshParts& mesh = parts.mesh->parts();
  std::vector<std::uint32_t> grounded;
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground0);
  auto ok = SolveColumns<double>(
      *mesh.rigid, added, grounded, cancel, [&](std::size_t j, std::span<const double> z) {
        std::copy(z.begin(), z.end(),
                  parts.z2.col(static_cast<Eigen::Index>(first_column + j)).data());
      });
  if (!ok) return ok;
  for (const MeshComponent& c : mesh.components) grounded.push_back(c.ground1);
  return SolveColumns<Complex>(
      *mesh.similarity, added, grounded, cancel, [&](std::size_t j, std::span<const Complex> z) {
        const auto column = static_cast<Eigen::Index>(first_column + j);
        for (std::size_t v = 0; v < z.size(); ++v) {
          parts.z1_real(static_cast<Eigen::Index>(v), column) = z[v].real();
          parts.z1_imag(static_cast<Eigen::Index>(v), column) = z[v].imag();
        }
      });
}

void BuildSaddles(CompiledHandlesParts& parts) {
  const RegisteredMeshParts& mesh = parts.mesh->parts();
  const auto k = static_cast<Eigen::Index>(parts.active_rows.size());
  const auto m = static_cast<Eigen::Index>(parts.active_components);
  Eigen::MatrixXcd cz1(k, k), cn1 = Eigen::MatrixXcd::Zero(k, 2 * m);
  Eigen::MatrixXd cz2(k, k), cn2 = Eigen::MatrixXd::Zero(k, m);
  for (Eigen::Index i = 0; i < k; ++i) {
    const Row& row = parts.rows[parts.active_rows[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < k; ++j) {
      const auto column = static_cast<Eigen::Index>(parts.active_rows[static_cast<std::size_t>(j)]);
      Complex z1 = 0;
      double z2 = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto v = static_cast<Eigen::Index>(row.vertex[c]);
        z1 += row.weight[c] * Complex(parts.z1_real(v, column), parts.z1_imag(v, column));
        z2 += row.weight[c] * parts.z2(v, column);
      }
      cz1(i, j) = z1;
      cz2(i, j) = z2;
    }
    cz1(i, i) += row.compliance;
    cz2(i, i) += row.compliance;
    const auto slot = static_cast<Eigen::Index>(parts.active_slot[row.component]);
    cn1(i, 2 * slot) = 1;
    cn1(i, 2 * slot + 1) = row.rest - mesh.components[row.component].center;
    cn2(i, slot) = 1;
  }
  parts.saddle1 = Saddle<Complex>(cz1, cn1);
  parts.saddle2 = Saddle<double>(cz2, cn2);
}

Status CheckIds(const std::vector<PlacedHandle>& kept, const std::vector<Handle>& added) {
  std::unordered_set<std::string_view> ids;
  for (const PlacedHandle& h : kept) ids.insert(h.handle.id);
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (ids.insert(added[i].id).second) continue;
    return Fail(Fault{FaultKind::kDuplicateHandle,
                      fmt::format("two handles have the id \"{}\"", added[i].id),
                      {static_cast<std::uint32_t>(i)},
                      {{"handle", added[i].id}},
                      fmt::format("handles[{}].handle_id", i)});
  }
  return {};
}

// `parts` comes with the kept handles, rows and their columns; adds the rest and decides all anew.
Status Extend(CompiledHandlesParts& parts, std::vector<Handle> add, const CancelToken& cancel) {
  if (auto ok = CheckIds(parts.handles, add); !ok) return ok;
  const RegisteredMeshParts& mesh = parts.mesh->parts();
  std::vector<Row> added;
  for (std::size_t i = 0; i < add.size(); ++i) {
    auto placement = PlaceHandle(mesh, add[i], i);
    if (!placement) return Fail(std::move(placement.error()));
    for (Row& row : placement->rows) {
      row.handle = static_cast<std::uint32_t>(parts.handles.size());
      added.push_back(row);
    }
    parts.handles.push_back(std::move(placement->placed));
  }
  const std::size_t first_column = parts.rows.size();
  const auto columns = static_cast<Eigen::Index>(first_column + added.size());
  const auto n = static_cast<Eigen::Index>(mesh.rest.size());
  parts.z1_real.conservativeResize(n, columns);
  parts.z1_imag.conservativeResize(n, columns);
  parts.z2.conservativeResize(n, columns);
  if (auto ok = FillColumns(parts, added, first_column, cancel); !ok) return ok;
  parts.rows.insert(parts.rows.end(), added.begin(), added.end());
  DecideRoles(parts);
  BuildSaddles(parts);
  return {};
}

// The parts of `from` without the removed handles, columns included.
std::unique_ptr<CompiledHandlesParts> Without(const CompiledHandlesParts& from,
                                              const std::vector<bool>& removed) {
  auto parts = std::make_unique<CompiledHandlesParts>();
  parts->mesh = from.mesh;
  std::vector<std::uint32_t> renumbered(from.handles.size(), 0);
  for (std::size_t h = 0; h < from.handles.size(); ++h) {
    renumbered[h] = static_cast<std::uint32_t>(parts->handles.size());
    if (!removed[h]) parts->handles.push_back(from.handles[h]);
  }
  std::vector<Eigen::Index> columns;
  for (std::size_t r = 0; r < from.rows.size(); ++r) {
    Row row = from.rows[r];
    if (removed[row.handle]) continue;
    row.handle = renumbered[row.handle];
    parts->rows.push_back(row);
    columns.push_back(static_cast<Eigen::Index>(r));
  }
  parts->z1_real = from.z1_real(Eigen::all, columns);
  parts->z1_imag = from.z1_imag(Eigen::all, columns);
  parts->z2 = from.z2(Eigen::all, columns);
  return parts;
}

}  // namespace

CompiledHandles::CompiledHandles(std::unique_ptr<const CompiledHandlesParts> parts)
    : parts_(std::move(parts)) {}
CompiledHandles::~CompiledHandles() = default;

Result<std::shared_ptr<const CompiledHandles>> CompiledHandles::Compile(
    std::shared_ptr<const RegisteredMesh> mesh, std::vector<Handle> handles,
    const CancelToken& cancel) {
  auto parts = std::make_unique<CompiledHandlesParts>();
  parts->mesh = std::move(mesh);
  if (auto ok = Extend(*parts, std::move(handles), cancel); !ok) return Fail(std::move(ok.error()));
  return std::shared_ptr<const CompiledHandles>(new CompiledHandles(std::move(parts)));
}

Result<std::shared_ptr<const CompiledHandles>> CompiledHandles::Edit(
    std::span<const std::string> remove, std::vector<Handle> add, const CancelToken& cancel) const {
  std::vector<bool> removed(parts_->handles.size(), false);
  for (const std::string& id : remove) {
    const auto index = Find(id);
    if (!index) {
      return Fail(Fault{FaultKind::kUnknownHandle,
                        fmt::format("no handle has the id \"{}\"", id),
                        {},
                        {{"handle", id}},
                        "remove"});
    }
    removed[*index] = true;
  }
  auto parts = Without(*parts_, removed);
  if (auto ok = Extend(*parts, std::move(add), cancel); !ok) return Fail(std::move(ok.error()));
  return std::shared_ptr<const CompiledHandles>(new CompiledHandles(std::move(parts)));
}

const std::shared_ptr<const RegisteredMesh>& CompiledHandles::mesh() const { return parts_->mesh; }
const std::vector<PlacedHandle>& CompiledHandles::handles() const { return parts_->handles; }
std::size_t CompiledHandles::rows() const { return parts_->rows.size(); }

std::optional<std::size_t> CompiledHandles::Find(std::string_view id) const {
  const auto& handles = parts_->handles;
  const auto it = std::find_if(handles.begin(), handles.end(),
                               [&](const PlacedHandle& h) { return h.handle.id == id; });
  if (it == handles.end()) return std::nullopt;
  return static_cast<std::size_t>(it - handles.begin());
}

std::vector<Target> CompiledHandles::RestTargets() const {
  std::vector<Target> targets;
  for (const PlacedHandle& h : parts_->handles) targets.push_back({h.rest, 0, 1});
  return targets;
}

std::size_t CompiledHandles::bytes() const {
  const auto k = static_cast<std::size_t>(parts_->saddle1.size());
  return static_cast<std::size_t>(parts_->z2.size()) * 3 * sizeof(double) +
         k * k * 2 * (sizeof(Complex) + sizeof(double)) + parts_->rows.size() * sizeof(Row);
}

std::size_t CompiledHandles::resting_components() const {
  return static_cast<std::size_t>(
      std::count(parts_->roles.begin(), parts_->roles.end(), ComponentRole::kResting));
}
std::size_t CompiledHandles::translating_components() const {
  return static_cast<std::size_t>(
      std::count(parts_->roles.begin(), parts_->roles.end(), ComponentRole::kTranslating));
}

std::vector<Warning> CompiledHandles::warnings() const {
  std::vector<Warning> warnings;
  Warning snapped{"snapped_handles", 0, {}, ""};
  for (std::uint32_t i = 0; i < parts_->handles.size(); ++i) {
    if (parts_->handles[i].snapped_distance == 0) continue;
    ++snapped.count;
    if (snapped.elements.size() < Fault::kMaxElements) snapped.elements.push_back(i);
  }
  snapped.message =
      fmt::format("{} handles lay outside the mesh and were moved to its boundary", snapped.count);
  if (snapped.count > 0) warnings.push_back(std::move(snapped));
  const auto add = [&](const char* kind, std::size_t count, const char* what) {
    if (count > 0)
      warnings.push_back({kind, count, {}, fmt::format("{} components {}", count, what)});
  };
  add("resting_components", resting_components(), "have no handle and stay at rest");
  add("translating_components", translating_components(),
      "have a single distinct handle and only translate");
  return warnings;
}

}  // namespace arap
