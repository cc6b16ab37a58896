#include "server/streams/targets.h"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "arap/core/deformer.h"
#include "core/base/names.h"
#include "core/base/try.h"

namespace arap::app {
namespace {

constexpr std::size_t kNamesInMessage = 5;

Fault Miscount(std::size_t count, std::size_t expected, const std::string& what) {
  return Fault(FaultKind::kTargetCount,
               fmt::format("There are {} targets for {} handles{}.", count, expected, what))
      .Detail("count", count)
      .Detail("expected", expected);
}

// Names the handles that nothing in `seen` moves.
Fault Missing(const CompiledHandles& handles, const std::vector<bool>& seen, std::size_t count) {
  std::string names;
  std::size_t missing = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] || ++missing > kNamesInMessage) continue;
    names += (names.empty() ? "" : ", ") + handles.handles()[i].handle.id;
  }
  if (missing > kNamesInMessage) names += ", ...";
  Fault fault = Miscount(count, seen.size(), fmt::format("; {} missing: {}", missing, names));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) fault.Element(static_cast<std::uint32_t>(i));
  }
  return fault.Detail("missing", names).Field("targets");
}

// The indices in the set of `count` ids, each at most once; `seen` is set for every handle found.
// One look-up in the set's index at most for each id.
template <class IdAt, class FieldAt>
Result<std::vector<std::size_t>> Resolve(const CompiledHandles& handles, std::size_t count,
                                         IdAt id_at, FieldAt field_at, std::vector<bool>& seen) {
  std::vector<std::size_t> order;
  order.reserve(count);
  seen.assign(handles.handles().size(), false);
  std::size_t next = 0;  // clients mostly keep the order of the set: look there first
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view id = id_at(i);
    const bool in_order = next < seen.size() && handles.handles()[next].handle.id == id;
    const auto index = in_order ? std::optional(next) : handles.Find(id);
    if (!index || seen[*index]) {
      return Fail(Fault(index ? FaultKind::kDuplicateHandle : FaultKind::kUnknownHandle,
                        index ? fmt::format("The handle {} is named twice.", Quote(id))
                              : fmt::format("There is no handle {}.", Quote(id)))
                      .Field(field_at(i))
                      .Detail("handle_id", std::string(id)));
    }
    seen[*index] = true;
    next = *index + 1;
    order.push_back(*index);
  }
  return order;
}

Result<std::vector<std::size_t>> ResolveTargets(const CompiledHandles& handles,
                                                std::span<const NamedTarget> named,
                                                std::vector<bool>& seen) {
  auto order = Resolve(
      handles, named.size(), [&](std::size_t i) { return named[i].handle_id; },
      [](std::size_t i) { return fmt::format("targets[{}].handle_id", i); }, seen);
  if (!order) return order;
  for (std::size_t i = 0; i < named.size(); ++i) {
    auto good = CheckTarget(named[i].target, "targets", i, named[i].handle_id);
    if (!good)
      return Fail(std::move(good.error().Element(static_cast<std::uint32_t>((*order)[i]))));
  }
  return order;
}

}  // namespace

Status MergeTargets(const CompiledHandles& handles, std::span<const NamedTarget> named,
                    std::vector<Target>& targets) {
  std::vector<bool> seen;
  TRY(const auto order, ResolveTargets(handles, named, seen));
  for (std::size_t i = 0; i < named.size(); ++i) targets[order[i]] = named[i].target;
  return {};
}

Status PackedTargets(const CompiledHandles& handles, std::span<const double> positions,
                     std::vector<Target>& targets) {
  const std::size_t expected = handles.handles().size();
  if (positions.size() != 2 * expected) {
    return Fail(Miscount(positions.size() / 2, expected,
                         fmt::format(", positions has {} numbers", positions.size()))
                    .Detail("length", positions.size())
                    .Field("positions"));
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (std::isfinite(positions[i])) continue;
    return Fail(Fault(FaultKind::kNonFiniteTarget, fmt::format("positions[{}] is not finite.", i))
                    .Field(fmt::format("positions[{}]", i))
                    .Element(static_cast<std::uint32_t>(i / 2))
                    .Detail("value", positions[i]));
  }
  for (std::size_t i = 0; i < expected; ++i) {
    targets[i].position = {positions[2 * i], positions[2 * i + 1]};
  }
  return {};
}

Result<std::vector<Target>> CompleteTargets(const CompiledHandles& handles,
                                            std::span<const NamedTarget> named) {
  std::vector<bool> seen;
  TRY(const auto order, ResolveTargets(handles, named, seen));
  if (named.size() != seen.size()) return Fail(Missing(handles, seen, named.size()));
  std::vector<Target> targets(named.size());
  for (std::size_t i = 0; i < named.size(); ++i) targets[order[i]] = named[i].target;
  return targets;
}

Result<std::vector<std::size_t>> CompleteOrder(const CompiledHandles& handles,
                                               std::span<const std::string_view> ids) {
  std::vector<bool> seen;
  auto order = Resolve(
      handles, ids.size(), [&](std::size_t i) { return ids[i]; },
      [](std::size_t i) { return fmt::format("handle_ids[{}]", i); }, seen);
  if (order && ids.size() != seen.size()) {
    return Fail(Missing(handles, seen, ids.size()).Field("handle_ids"));
  }
  return order;
}

}  // namespace arap::app
