#include "arap/core/compiled_handles.h"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/deform/direct_solver.h"
#include "core/deform/null_space_solver.h"
#include "core/deform/target_rows.h"
#include "core/mesh/validation.h"

namespace arap {
namespace {

Status CheckIds(const std::vector<PlacedHandle>& kept, const std::vector<Handle>& added,
                std::string_view array) {
  std::unordered_set<std::string_view> ids;
  for (const PlacedHandle& h : kept) ids.insert(h.handle.id);
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (ids.insert(added[i].id).second) continue;
    return Fail(Fault(FaultKind::kDuplicateHandle,
                      fmt::format("Two handles have the id \"{}\".", added[i].id))
                    .Field(fmt::format("{}[{}].handle_id", array, i))
                    .Element(static_cast<std::uint32_t>(i))
                    .Detail("handle_id", added[i].id));
  }
  return {};
}

// `parts` comes with the kept handles, rows and their columns; adds the rest, which the caller calls
// `array`, and decides all anew.
Status Extend(CompiledHandlesParts& parts, const std::vector<Handle>& add, std::string_view array,
              const CancelToken& cancel) {
  CHECK_OK(CheckIds(parts.handles, add, array));
  const RegisteredMeshParts& mesh = parts.mesh->parts();
  TRY(auto placements, PlaceHandles(mesh, add, array, parts.rows.size(), cancel));
  for (Placement& placement : placements) {
    for (Row& row : placement.rows) {
      row.handle = static_cast<std::uint32_t>(parts.handles.size());
      parts.rows.push_back(row);
    }
    parts.handles.push_back(std::move(placement.placed));
  }
  parts.index = HandleIndex(parts.handles);
  parts.count = {};
  for (const Row& row : parts.rows) CountRow(row, parts.count);
  for (const PlacedHandle& h : parts.handles) parts.count.depths += h.handle.depth != 0 ? 1u : 0u;
  TRY(parts.roles, DecideRoles(mesh.components.size(), parts.rows, cancel));
  TRY(parts.depths, ComputeDepths(mesh, parts.handles, cancel));
  const bool direct = FactorsDirectly(parts.rows.size(), parts.choice);
  if (direct && !parts.roles.active_rows.empty()) {
    parts.responses.reset();
    TRY(parts.solver, DirectSolver::Make(parts, cancel));
    return {};
  }
  // Responses that the set came with are those of its first rows.
  auto responses = parts.responses ? std::make_shared<Responses>(*parts.responses)
                                   : std::make_shared<Responses>();
  const auto known = static_cast<std::ptrdiff_t>(responses->rows());
  const std::vector<Row> missing(parts.rows.begin() + known, parts.rows.end());
  CHECK_OK(responses->Append(mesh, missing, cancel));
  parts.responses = std::move(responses);
  parts.solver = std::make_shared<NullSpaceSolver>(parts);
  return {};
}

// The parts of `from` without the removed handles, columns included.
std::unique_ptr<CompiledHandlesParts> Without(const CompiledHandlesParts& from,
                                              const std::vector<bool>& removed) {
  auto parts = std::make_unique<CompiledHandlesParts>();
  parts->mesh = from.mesh;
  parts->choice = from.choice;
  std::vector<std::uint32_t> renumbered(from.handles.size(), 0);
  for (std::size_t h = 0; h < from.handles.size(); ++h) {
    renumbered[h] = static_cast<std::uint32_t>(parts->handles.size());
    if (!removed[h]) parts->handles.push_back(from.handles[h]);
  }
  std::vector<std::size_t> columns;
  for (std::size_t r = 0; r < from.rows.size(); ++r) {
    Row row = from.rows[r];
    if (removed[row.handle]) continue;
    row.handle = renumbered[row.handle];
    parts->rows.push_back(row);
    columns.push_back(r);
  }
  if (from.responses)
    parts->responses = std::make_shared<Responses>(from.responses->Select(columns));
  return parts;
}

}  // namespace

CompiledHandles::CompiledHandles(std::unique_ptr<const CompiledHandlesParts> parts)
    : parts_(std::move(parts)) {}
CompiledHandles::~CompiledHandles() = default;

Result<std::shared_ptr<const CompiledHandles>> CompiledHandles::Compile(
    std::shared_ptr<const RegisteredMesh> mesh, const std::vector<Handle>& handles,
    const CancelToken& cancel, HandleSolver solver) {
  auto parts = std::make_unique<CompiledHandlesParts>();
  parts->mesh = std::move(mesh);
  parts->choice = solver;
  CHECK_OK(OrOutOfMemory([&] { return Extend(*parts, handles, "handles", cancel); }));
  return std::shared_ptr<const CompiledHandles>(new CompiledHandles(std::move(parts)));
}

Result<std::shared_ptr<const CompiledHandles>> CompiledHandles::Edit(
    std::span<const std::string> remove, const std::vector<Handle>& add,
    const CancelToken& cancel) const {
  std::vector<bool> removed(parts_->handles.size(), false);
  for (const std::string& id : remove) {
    const auto index = Find(id);
    if (!index) {
      return Fail(Fault(FaultKind::kUnknownHandle, fmt::format("No handle has the id \"{}\".", id))
                      .Field("remove")
                      .Detail("handle_id", id));
    }
    removed[*index] = true;
  }
  auto parts = Without(*parts_, removed);
  CHECK_OK(OrOutOfMemory([&] { return Extend(*parts, add, "add", cancel); }));
  return std::shared_ptr<const CompiledHandles>(new CompiledHandles(std::move(parts)));
}

const std::shared_ptr<const RegisteredMesh>& CompiledHandles::mesh() const { return parts_->mesh; }
const std::vector<PlacedHandle>& CompiledHandles::handles() const { return parts_->handles; }
std::size_t CompiledHandles::rows() const { return parts_->rows.size(); }

std::optional<std::size_t> CompiledHandles::Find(std::string_view id) const {
  return parts_->index.Find(parts_->handles, id,
                            [](std::string_view a, std::string_view b) { return a.compare(b); });
}

std::vector<Target> CompiledHandles::RestTargets() const {
  std::vector<Target> targets;
  for (const PlacedHandle& h : parts_->handles) targets.push_back({h.rest, 0, 1});
  return targets;
}

Status CompiledHandles::CheckHard(std::span<const Target> targets) const {
  if (parts_->roles.dependent.empty()) return {};
  return TargetRows(*parts_).Place(targets);
}

bool CompiledHandles::direct() const { return parts_->responses == nullptr; }

std::size_t CompiledHandles::bytes() const {
  constexpr std::size_t kBlock = 16;  // of the allocator, beside what was asked for
  std::size_t ids = 0;
  for (const PlacedHandle& h : parts_->handles) {
    const std::size_t length = h.handle.id.capacity();
    ids += length > std::string().capacity() ? length + kBlock : 0;
  }
  return parts_->solver->bytes() + parts_->rows.size() * sizeof(Row) + parts_->index.bytes() +
         parts_->handles.size() * sizeof(PlacedHandle) + ids +
         parts_->depths.size() * sizeof(double);
}

std::size_t CompiledHandles::resting_components() const {
  const auto& roles = parts_->roles.of;
  return static_cast<std::size_t>(std::count(roles.begin(), roles.end(), ComponentRole::kResting));
}
std::size_t CompiledHandles::translating_components() const {
  const auto& roles = parts_->roles.of;
  return static_cast<std::size_t>(
      std::count(roles.begin(), roles.end(), ComponentRole::kTranslating));
}

std::vector<Warning> CompiledHandles::warnings() const {
  std::vector<Warning> warnings;
  std::vector<std::uint32_t> snapped;
  for (std::uint32_t i = 0; i < parts_->handles.size(); ++i) {
    if (parts_->handles[i].snapped_distance != 0) snapped.push_back(i);
  }
  AddWarning(
      "snapped_handles", snapped,
      fmt::format("{} handles lay outside the mesh and were moved to its boundary", snapped.size()),
      warnings);
  const auto add = [&](const char* kind, std::size_t count, const char* what) {
    if (count == 0) return;
    warnings.push_back({kind, count, {}, fmt::format("{} components {}", count, what)});
  };
  add("resting_components", resting_components(), "have no handle and stay at rest");
  add("translating_components", translating_components(),
      "have a single distinct handle and only translate");
  return warnings;
}

}  // namespace arap
