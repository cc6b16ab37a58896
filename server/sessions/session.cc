#include "server/sessions/session.h"

#include <algorithm>
#include <utility>

#include "server/sessions/names.h"

namespace arap::app {

using std::chrono::duration_cast;
using std::chrono::milliseconds;

Session::Session(Record record, runtime::Clock::Steady expires, const runtime::Clock& clock)
    : key_(record->key),
      ttl_(record->ttl),
      clock_(clock),
      record_(std::move(record)),
      expires_(expires),
      stored_expires_(record_->expires) {}

Session::Record Session::record() const {
  const std::lock_guard lock(mutex_);
  return record_;
}

void Session::Replace(Record record) {
  const std::lock_guard lock(mutex_);
  stored_expires_ = record->expires;
  record_.swap(record);
}

runtime::Clock::Wall Session::WallExpiryLocked() const {
  return clock_.WallNow() + duration_cast<milliseconds>(expires_ - clock_.SteadyNow());
}

SessionView Session::View() const {
  const std::lock_guard lock(mutex_);
  return ViewOf(*record_, WallExpiryLocked());
}

Status Session::Touch() {
  const std::lock_guard lock(mutex_);
  const auto now = clock_.SteadyNow();
  if (ended_ || now >= expires_) return Fail(NotFound("session", key_.id));
  // Not earlier: one that was read from the store may have been promised longer.
  expires_ = std::max(expires_, now + ttl_);
  return {};
}

bool Session::expired() const {
  const std::lock_guard lock(mutex_);
  return clock_.SteadyNow() >= expires_;
}

bool Session::NeedsStoring(runtime::Clock::Wall* expires) const {
  const std::lock_guard lock(mutex_);
  const auto wanted = WallExpiryLocked() + kStoredLonger;
  if (ended_ || wanted - stored_expires_ < kStoredLonger / 2) return false;
  *expires = std::chrono::time_point_cast<milliseconds>(wanted);
  return true;
}

void Session::Stored(runtime::Clock::Wall expires) {
  const std::lock_guard lock(mutex_);
  stored_expires_ = std::max(stored_expires_, expires);
}

runtime::Clock::Wall Session::stored_expires() const {
  const std::lock_guard lock(mutex_);
  return stored_expires_;
}

void Session::End() {
  std::map<std::uint64_t, Listener> listeners;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    listeners.swap(listeners_);
  }
  for (const auto& [id, listener] : listeners) listener();
}

std::uint64_t Session::AddEndListener(Listener listener) {
  {
    const std::lock_guard lock(mutex_);
    if (!ended_) {
      const std::uint64_t id = next_listener_++;
      listeners_.emplace(id, std::move(listener));
      return id;
    }
  }
  listener();
  return 0;
}

void Session::RemoveEndListener(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  listeners_.erase(id);
}

Result<store::MeshRecord> FindMesh(const store::SessionRecord& record, const std::string& mesh_id) {
  const auto found = record.meshes.find(mesh_id);
  if (found == record.meshes.end()) return Fail(NotFound("mesh", mesh_id));
  return found->second;
}

Result<store::HandleSetRecord> FindHandleSet(const store::SessionRecord& record,
                                             const std::string& handle_set_id) {
  const auto found = record.handle_sets.find(handle_set_id);
  if (found == record.handle_sets.end()) return Fail(NotFound("handle set", handle_set_id));
  return found->second;
}

SessionView ViewOf(const store::SessionRecord& record, runtime::Clock::Wall expires) {
  SessionView view{record.key.owner,
                   {record.key.id, record.ttl, record.labels},
                   record.created,
                   expires,
                   {},
                   {}};
  for (const auto& [id, mesh] : record.meshes) view.mesh_ids.push_back(id);
  for (const auto& [id, set] : record.handle_sets) view.handle_set_ids.push_back(id);
  return view;
}

}  // namespace arap::app
