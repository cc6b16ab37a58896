#include "server/sessions/session.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "server/budget/faults.h"

namespace arap::app {
namespace {

// What no server is configured to exceed.
constexpr std::chrono::milliseconds kMinTtl = std::chrono::seconds(1);
constexpr std::size_t kMaxLabels = 16;
constexpr std::size_t kMaxLabelBytes = 128;
constexpr std::size_t kMaxPageSize = 1'000;

Fault BadOption(std::string message, std::string field) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(std::move(field));
}

}  // namespace

using std::chrono::duration_cast;
using std::chrono::milliseconds;

Session::Session(Record record, Room room, runtime::Clock::Steady expires,
                 const runtime::Clock& clock)
    : key_(record->key),
      ttl_(record->ttl),
      clock_(clock),
      record_(std::move(record)),
      room_(std::move(room)),
      expires_(expires),
      stored_expires_(record_->expires) {}

Session::Record Session::record() const {
  const MutexLock lock(&mutex_);
  return record_;
}

void Session::Replace(Record record, Room room) {
  const MutexLock lock(&mutex_);
  stored_expires_ = record->expires;
  record_.swap(record);
  std::swap(room_, room);
}

void Session::Reload(store::SessionRecord record, Room room) {
  const Record before = this->record();
  for (auto& [id, set] : record.handle_sets) {
    const auto known = before->handle_sets.find(id);
    if (known != before->handle_sets.end() &&
        store::SameDefinitions(known->second.definitions, set.definitions)) {
      set.definitions = known->second.definitions;
    }
  }
  Replace(std::make_shared<const store::SessionRecord>(std::move(record)), std::move(room));
}

runtime::Clock::Wall Session::ExpiryAtLocked(runtime::Clock::Wall now) const {
  return now + duration_cast<milliseconds>(expires_ - clock_.SteadyNow());
}

runtime::Clock::Wall Session::ExpiryAt(runtime::Clock::Wall now) const {
  const MutexLock lock(&mutex_);
  return ExpiryAtLocked(now);
}

SessionView Session::View() const {
  const MutexLock lock(&mutex_);
  return ViewOf(*record_, ExpiryAtLocked(clock_.WallNow()));
}

Status Session::Touch() {
  const MutexLock lock(&mutex_);
  const auto now = clock_.SteadyNow();
  if (ended_ || now >= expires_) return Fail(NotFound("session", key_.id));
  // Not earlier: one that was read from the store may have been promised longer.
  expires_ = std::max(expires_, now + ttl_);
  return {};
}

bool Session::expired() const {
  const MutexLock lock(&mutex_);
  return clock_.SteadyNow() >= expires_;
}

bool Session::NeedsStoring(runtime::Clock::Wall now, runtime::Clock::Wall* expires) const {
  const MutexLock lock(&mutex_);
  const auto wanted = ExpiryAtLocked(now) + kStoredLonger;
  const milliseconds lag = ttl_ < kShortTtl ? kStoredLonger / 6 : kStoredLonger / 2;
  if (ended_ || wanted - stored_expires_ < lag) return false;
  *expires = std::chrono::time_point_cast<milliseconds>(wanted);
  return true;
}

void Session::Stored(runtime::Clock::Wall expires) {
  const MutexLock lock(&mutex_);
  stored_expires_ = std::max(stored_expires_, expires);
}

void Session::Shifted(milliseconds jump) {
  const MutexLock lock(&mutex_);
  stored_expires_ += jump;
}

runtime::Clock::Wall Session::stored_expires() const {
  const MutexLock lock(&mutex_);
  return stored_expires_;
}

void Session::End() {
  std::map<std::uint64_t, Listener> listeners;
  {
    const MutexLock lock(&mutex_);
    ended_ = true;
    listeners.swap(listeners_);
  }
  for (const auto& [id, listener] : listeners) listener();
}

std::uint64_t Session::AddEndListener(Listener listener) {
  {
    const MutexLock lock(&mutex_);
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
  const MutexLock lock(&mutex_);
  listeners_.erase(id);
}

std::size_t BytesOf(const store::SessionRecord& record) {
  constexpr std::size_t kEntry = 256;  // a node of a map with its names
  constexpr std::size_t kId = 96;      // of a handle: most are shorter, and looking at each is dear
  std::size_t bytes =
      kEntry * (1 + record.meshes.size() + record.handle_sets.size() + record.jobs.size());
  for (const auto& [id, set] : record.handle_sets) {
    bytes += set.definitions->size() * (sizeof(Handle) + kId);
  }
  return bytes;
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

Result<store::JobRecord> FindJob(const store::SessionRecord& record, const std::string& job_id) {
  const auto found = record.jobs.find(job_id);
  if (found == record.jobs.end()) return Fail(NotFound("job", job_id));
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

Status CheckSpec(const SessionSpec& spec, const Limits& limits) {
  if (auto name = CheckName(spec.id, "session_id"); !name) return name;
  if (spec.ttl < kMinTtl || spec.ttl > limits.max_ttl) {
    const double max_seconds = std::chrono::duration<double>(limits.max_ttl).count();
    Fault fault =
        BadOption(fmt::format("The ttl of {} s is not between 1 s and {} s.",
                              std::chrono::duration<double>(spec.ttl).count(), max_seconds),
                  "ttl");
    return Fail(fault.Detail("limit", fmt::format("{}", max_seconds)).Detail("quota", "max_ttl"));
  }
  if (spec.labels.size() > kMaxLabels) {
    Fault fault =
        BadOption(fmt::format("There are {} labels, more than {}.", spec.labels.size(), kMaxLabels),
                  "labels");
    return Fail(fault.Detail("count", std::to_string(spec.labels.size()))
                    .Detail("limit", std::to_string(kMaxLabels)));
  }
  for (const auto& [key, value] : spec.labels) {
    if (key.empty() || key.size() > kMaxLabelBytes || value.size() > kMaxLabelBytes) {
      Fault fault = BadOption(
          fmt::format("The label {} is empty or longer than {} bytes.", Quote(key), kMaxLabelBytes),
          "labels");
      return Fail(fault.Detail("limit", std::to_string(kMaxLabelBytes)));
    }
  }
  return {};
}

Status CheckPage(std::size_t size, const std::string& token) {
  if (size > kMaxPageSize) {
    Fault fault = BadOption(fmt::format("The page size of {} is more than {}.", size, kMaxPageSize),
                            "page_size");
    return Fail(fault.Detail("limit", std::to_string(kMaxPageSize)));
  }
  if (!token.empty() && !IsName(token)) {
    return Fail(BadOption("The page token was not given by this server.", "page_token"));
  }
  return {};
}

}  // namespace arap::app
