#include "client/src/replay_log.h"

#include <iterator>
#include <utility>

namespace arap::client::internal {
namespace {

v1::HandleUpdate& NewUpdate(std::uint64_t sequence, std::vector<v1::StreamDeformRequest>& out) {
  v1::HandleUpdate& update = *out.emplace_back().mutable_update();
  update.set_sequence(sequence);
  return update;
}

void SayTargets(const std::map<std::string, v1::HandleTarget>& targets, std::uint64_t sequence,
                std::vector<v1::StreamDeformRequest>& out) {
  if (targets.empty()) return;
  v1::HandleUpdate& update = NewUpdate(sequence, out);
  for (const auto& [id, target] : targets) *update.add_targets() = target;
}

}  // namespace

std::uint64_t SequenceOf(const v1::StreamDeformRequest& request) {
  return request.has_edit() ? request.edit().sequence() : request.update().sequence();
}

void ReplayLog::Pose::Add(const v1::HandleUpdate& update) {
  if (update.positions_size() > 0) {
    if (!after.empty()) before_sequence = after_sequence;
    for (auto& [id, target] : std::exchange(after, {})) before[id] = std::move(target);
    positions.assign(update.positions().begin(), update.positions().end());
    positions_sequence = update.sequence();
  }
  if (update.targets_size() > 0) after_sequence = update.sequence();
  for (const v1::HandleTarget& target : update.targets()) after[target.handle_id()] = target;
}

void ReplayLog::Pose::Say(std::vector<v1::StreamDeformRequest>& out) const {
  SayTargets(before, before_sequence, out);
  if (!positions.empty()) {
    NewUpdate(positions_sequence, out).mutable_positions()->Add(positions.begin(), positions.end());
  }
  SayTargets(after, after_sequence, out);
}

bool ReplayLog::Sent(const v1::StreamDeformRequest& request) {
  const std::uint64_t sequence = SequenceOf(request);
  if (sent_ && sequence <= *sent_) return false;
  sent_ = sequence;
  pending_.push_back(request);
  if (latest_ && pending_.size() > kMostPending) Fold();
  return true;
}

// The last update before an edit, and the newest of all, are answered in any case: they stay as
// they were sent.
void ReplayLog::Fold() {
  std::vector<v1::StreamDeformRequest> folded;
  for (auto at = pending_.begin(); at != pending_.end();) {
    Pose pose;
    bool measure = false;
    auto next = std::next(at);
    for (; !at->has_edit() && next != pending_.end() && !next->has_edit(); at = next++) {
      pose.Add(at->update());
      measure |= at->update().measure();
    }
    if (measure) at->mutable_update()->set_measure(true);
    pose.Say(folded);
    folded.push_back(std::move(*at));
    at = next;
  }
  pending_.assign(std::move_iterator(folded.begin()), std::move_iterator(folded.end()));
}

bool ReplayLog::Answered(std::uint64_t sequence, bool good) {
  if (answered_ && sequence <= *answered_) return false;
  answered_ = sequence;
  while (!pending_.empty() && SequenceOf(pending_.front()) <= sequence) {
    v1::StreamDeformRequest request = std::move(pending_.front());
    pending_.pop_front();
    if (good || SequenceOf(request) < sequence) Keep(std::move(request));
  }
  return true;
}

void ReplayLog::Keep(v1::StreamDeformRequest&& request) {
  if (request.has_edit()) {
    edits_.push_back({std::exchange(pose_, {}), std::move(request)});
  } else {
    pose_.Add(request.update());
  }
}

std::vector<v1::StreamDeformRequest> ReplayLog::Messages() const {
  std::vector<v1::StreamDeformRequest> messages;
  for (const Edited& edited : edits_) {
    edited.before.Say(messages);
    messages.push_back(edited.edit);
  }
  pose_.Say(messages);
  messages.insert(messages.end(), pending_.begin(), pending_.end());
  return messages;
}

}  // namespace arap::client::internal
