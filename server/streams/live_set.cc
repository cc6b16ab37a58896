#include "server/streams/live_set.h"

#include <utility>

#include "server/sessions/handle_sets.h"
#include "server/streams/pose.h"

namespace arap::app {

LiveSet::LiveSet(HandleSetEntry entry)
    : entry_(std::move(entry)),
      targets_(entry_.handles->RestTargets()),
      deformer_(entry_.handles) {}

Result<LiveSet> LiveSet::Edited(const std::vector<std::string>& remove,
                                const std::vector<Handle>& add, const DeformOptions& options,
                                const Limits& limits, const CancelToken& cancel,
                                ShapeQuality& quality) const {
  auto entry = EditEntry(entry_, remove, add, limits, cancel);
  if (!entry) return Fail(std::move(entry.error()));
  LiveSet edited(*std::move(entry));

  const std::vector<PlacedHandle>& placed = edited.handles().handles();
  const std::size_t kept = placed.size() - add.size();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto before = i < kept ? handles().Find(placed[i].handle.id) : std::nullopt;
    edited.targets_[i] = before
                             ? targets_[*before]
                             : PoseOf(handles().mesh()->mesh(), placed[i], deformer_.positions());
  }
  auto updated = edited.deformer_.Update(edited.targets_, options);
  if (!updated) return Fail(std::move(updated.error()));
  quality = *updated;
  return edited;
}

}  // namespace arap::app
