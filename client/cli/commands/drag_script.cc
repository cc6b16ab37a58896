#include "client/cli/commands/drag_script.h"

#include <utility>

#include "client/cli/adapt.h"

namespace arap::cli {
namespace {

// Sequences grow from 1: two for each frame, the edit before it and its update.
constexpr std::uint64_t EditSequence(std::size_t frame) { return 2 * frame + 1; }
constexpr std::uint64_t UpdateSequence(std::size_t frame) { return 2 * frame + 2; }

}  // namespace

DragScript::DragScript(const Track& track, bool hard, std::vector<double> pick_points)
    : track_(track),
      hard_(hard),
      pick_points_(std::move(pick_points)),
      segments_(SegmentsOf(track)) {}

const TrackEdit* DragScript::EditAt(std::size_t frame) const {
  const TrackSegment& segment = SegmentAt(segments_, frame);
  return segment.first == frame ? segment.edit : nullptr;
}

Status DragScript::SendEdit(client::DeformStream& stream, std::size_t frame) const {
  const TrackEdit* const edit = EditAt(frame);
  if (edit == nullptr) return {};
  return stream.Edit(EditSequence(frame), edit->remove,
                     ToClient(ToHandles(track_, edit->add, hard_)));
}

Status DragScript::SendUpdate(client::DeformStream& stream, std::size_t frame) const {
  client::HandleUpdate update;
  update.sequence = UpdateSequence(frame);
  if (frame + 1 == frame_count()) update.pick_points = pick_points_;
  const std::vector<Target>& targets = track_.frames[frame].targets;
  client::TrackFrame flat = ToClient(targets);
  if (track_.edits.empty() && flat.angles_radians.empty() && flat.scales.empty()) {
    update.positions = std::move(flat.positions);
    return stream.Send(update);
  }
  // By id: whatever order an edit leaves the handles in, each goes where the frame says.
  const std::vector<std::string>& ids = SegmentAt(segments_, frame).ids;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    update.targets.push_back(ToClient(ids[k], targets[k]));
  }
  return stream.Send(update);
}

std::optional<DragCue> DragScript::CueOf(std::uint64_t sequence) const {
  if (sequence < 1 || sequence > 2 * frame_count()) return std::nullopt;
  const DragCue cue{(sequence - 1) / 2, sequence % 2 == 1};
  if (cue.edit && EditAt(cue.frame) == nullptr) return std::nullopt;
  return cue;
}

}  // namespace arap::cli
