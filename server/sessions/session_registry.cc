#include "server/sessions/session_registry.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/sessions/names.h"
#include "server/sessions/session_spec.h"

namespace arap::app {
namespace {

using std::chrono::milliseconds;

// Expired records that one sweep removes at most.
constexpr std::size_t kSweep = 1'000;

runtime::Clock::Wall WholeMilliseconds(runtime::Clock::Wall time) {
  return std::chrono::time_point_cast<milliseconds>(time);
}

}  // namespace

SessionRegistry::SessionRegistry(const Limits& limits, const runtime::Clock& clock,
                                 store::SpecStore& store,
                                 std::function<void(const store::SessionRecord&)> released)
    : limits_(limits), clock_(clock), store_(store), released_(std::move(released)) {}

SessionRegistry::Found SessionRegistry::InMemory(const store::SessionKey& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(key);
  return found == sessions_.end() ? nullptr : found->second;
}

std::size_t SessionRegistry::in_memory() const {
  const std::lock_guard lock(mutex_);
  return sessions_.size();
}

void SessionRegistry::Drop(const Found& session) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(session->key());
    if (found == sessions_.end() || found->second != session) return;
    sessions_.erase(found);
  }
  session->End();
  released_(*session->record());
}

Status SessionRegistry::Expire(const Found& session) {
  const std::lock_guard writing(writes_);
  // The id may have been freed and taken anew meanwhile.
  if (InMemory(session->key()) != session) return {};
  bool ours = true;
  if (store_.shared()) {
    auto record = store_.Load(session->key());
    // What cannot be read is the store's to remove, when it expires there.
    if (!record && record.error().kind != FaultKind::kDataLoss) {
      return Fail(std::move(record.error()));
    }
    ours = record && *record && (*record)->expires <= session->stored_expires();
  }
  if (ours) {
    auto removed = store_.Remove(session->key());
    if (!removed) return Fail(std::move(removed.error()));
  }
  Drop(session);
  return {};
}

Status SessionRegistry::ExpireAll() {
  std::vector<Found> expired;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, session] : sessions_) {
      if (session->expired()) expired.push_back(session);
    }
  }
  for (const Found& session : expired) {
    if (auto gone = Expire(session); !gone) return gone;
  }
  return {};
}

Result<SessionRegistry::Found> SessionRegistry::Find(const store::SessionKey& key) {
  const auto missing = [&] { return Fail(NotFound("session", key.id)); };
  Found session = InMemory(key);
  if (session && session->expired()) {
    if (auto gone = Expire(session); !gone) return Fail(std::move(gone.error()));
    if (!store_.shared()) return missing();
    session = nullptr;
  }
  if (session) {
    if (!store_.shared()) return session;
    auto revision = store_.Revision(key);
    if (!revision) return Fail(std::move(revision.error()));
    if (*revision && **revision == session->record()->revision) return session;
  }
  auto loaded = store_.Load(key);
  if (!loaded) return Fail(std::move(loaded.error()));
  // Stored longer than told, and the store may lag behind by half of that.
  const auto now = clock_.WallNow();
  const auto expires = *loaded ? (*loaded)->expires - kStoredLonger / 2 : now;
  if (now >= expires) {
    if (session) Drop(session);
    if (*loaded) {
      if (auto removed = store_.Remove(key); !removed) return Fail(std::move(removed.error()));
    }
    return missing();
  }
  auto record = std::make_shared<const store::SessionRecord>(**std::move(loaded));
  if (session) {
    session->Replace(std::move(record));
    return session;
  }
  session =
      std::make_shared<Session>(std::move(record), clock_.SteadyNow() + (expires - now), clock_);
  const std::lock_guard lock(mutex_);
  return sessions_.emplace(key, std::move(session)).first->second;
}

Status SessionRegistry::CheckRoom(const Caller& caller) {
  for (const bool swept : {false, true}) {
    auto usage = store_.UsageOf(caller.owner);
    if (!usage) return Fail(std::move(usage.error()));
    auto count = store_.Count();
    if (!count) return Fail(std::move(count.error()));
    const bool owner_full = usage->sessions >= caller.limits.max_sessions;
    if (!owner_full && *count < limits_.max_sessions) return {};
    if (swept) {
      return Fail(owner_full ? QuotaFull("max_sessions_per_owner", caller.limits.max_sessions)
                             : QuotaFull("max_sessions", limits_.max_sessions));
    }
    if (auto gone = ExpireAll(); !gone) return gone;
  }
  return {};
}

Result<SessionView> SessionRegistry::Create(const Caller& caller, SessionSpec spec) {
  if (spec.ttl == milliseconds::zero()) spec.ttl = limits_.default_ttl;
  if (auto good = CheckSpec(spec, limits_); !good) return Fail(std::move(good.error()));
  const store::SessionKey key{caller.owner, spec.id};
  const std::lock_guard writing(writes_);
  auto found = Find(key);
  if (found) {
    if ((*found)->View().spec == spec && (*found)->Touch()) return (*found)->View();
    return Fail(Taken("session", spec.id, "another ttl or other labels"));
  }
  if (found.error().kind != FaultKind::kNotFound) return Fail(std::move(found.error()));
  if (auto room = CheckRoom(caller); !room) return Fail(std::move(room.error()));

  auto record = std::make_shared<store::SessionRecord>();
  record->key = key;
  record->ttl = spec.ttl;
  record->labels = std::move(spec.labels);
  record->created = WholeMilliseconds(clock_.WallNow());
  record->expires = record->created + record->ttl + kStoredLonger;
  auto put = store_.Put(*record);
  if (!put) return Fail(std::move(put.error()));
  if (!*put) {
    return Fail(FaultKind::kStoreUnavailable,
                fmt::format("Another server takes the session id {} just now.", Quote(key.id)));
  }
  auto session = std::make_shared<Session>(record, clock_.SteadyNow() + record->ttl, clock_);
  {
    const std::lock_guard lock(mutex_);
    sessions_[key] = session;
  }
  return session->View();
}

Result<std::shared_ptr<Session>> SessionRegistry::Use(const std::string& owner,
                                                      const std::string& id) {
  auto session = Find({owner, id});
  if (!session) return session;
  if (auto alive = (*session)->Touch(); !alive) return Fail(std::move(alive.error()));
  return session;
}

std::shared_ptr<Session> SessionRegistry::Peek(const std::string& owner, const std::string& id) {
  if (store_.shared()) return nullptr;
  Found session = InMemory({owner, id});
  return session && session->Touch() ? session : nullptr;
}

Result<SessionView> SessionRegistry::View(const std::string& owner, const std::string& id) {
  return Find({owner, id}).map([](const Found& session) { return session->View(); });
}

Result<SessionPage> SessionRegistry::List(const std::string& owner, std::size_t size,
                                          const std::string& token) {
  if (auto good = CheckPage(size, token); !good) return Fail(std::move(good.error()));
  if (size == 0) size = kDefaultPageSize;
  if (auto gone = ExpireAll(); !gone) return Fail(std::move(gone.error()));
  auto records = store_.List(owner, token, size + 1);
  if (!records) return Fail(std::move(records.error()));
  SessionPage page;
  if (records->size() > size) {
    records->resize(size);
    page.next_token = records->back().key.id;
  }
  const auto now = clock_.WallNow();
  for (const store::SessionRecord& record : *records) {
    const Found session = InMemory(record.key);
    const auto expires = record.expires - kStoredLonger / 2;
    if (!session && now >= expires) continue;
    SessionView view = ViewOf(record, expires);
    if (session) view.expires = session->View().expires;
    page.sessions.push_back(std::move(view));
  }
  return page;
}

Status SessionRegistry::Delete(const std::string& owner, const std::string& id) {
  const std::lock_guard writing(writes_);
  auto session = Find({owner, id});
  if (!session && session.error().kind == FaultKind::kDataLoss) {
    // What cannot be read can still be got rid of.
    auto gone = store_.Remove({owner, id});
    if (!gone) return Fail(std::move(gone.error()));
    if (const Found known = InMemory({owner, id})) Drop(known);
    return {};
  }
  if (!session) return Fail(std::move(session.error()));
  auto removed = store_.Remove((*session)->key());
  if (!removed) return Fail(std::move(removed.error()));
  Drop(*session);
  if (!*removed) return Fail(NotFound("session", id));
  return {};
}

Result<Session::Record> SessionRegistry::Change(Session& session, const Edit& edit) {
  const std::lock_guard writing(writes_);
  for (;;) {
    if (auto alive = session.Touch(); !alive) return Fail(std::move(alive.error()));
    const Session::Record before = session.record();
    auto after = std::make_shared<store::SessionRecord>(*before);
    auto changed = edit(*after);
    if (!changed) return Fail(std::move(changed.error()));
    if (!*changed) return before;
    ++after->revision;
    after->expires =
        WholeMilliseconds(std::max(before->expires, session.View().expires + kStoredLonger));
    auto put = store_.Put(*after);
    if (!put) return Fail(std::move(put.error()));
    if (*put) {
      session.Replace(after);
      return after;
    }
    // Another process changed or removed it.
    auto now = store_.Load(session.key());
    if (!now) return Fail(std::move(now.error()));
    if (!*now) {
      if (const Found ours = InMemory(session.key()); ours.get() == &session) Drop(ours);
      return Fail(NotFound("session", session.key().id));
    }
    session.Replace(std::make_shared<const store::SessionRecord>(**std::move(now)));
  }
}

bool SessionRegistry::InUse(const std::string& owner, const std::string& blob) const {
  const std::lock_guard lock(mutex_);
  for (auto at = sessions_.lower_bound({owner, ""});
       at != sessions_.end() && at->first.owner == owner; ++at) {
    const Session::Record record = at->second->record();
    for (const auto& [id, mesh] : record->meshes) {
      if (mesh.blob == blob) return true;
    }
  }
  return false;
}

Status SessionRegistry::Sweep() {
  std::vector<Found> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, session] : sessions_) all.push_back(session);
  }
  for (const Found& session : all) {
    runtime::Clock::Wall expires;
    if (!session->NeedsStoring(&expires)) continue;
    const auto there = store_.Extend(session->key(), expires);
    if (!there) return Fail(there.error());
    if (*there) {
      session->Stored(expires);
    } else {
      Drop(session);  // another server deleted it: its streams end here too
    }
  }
  const std::lock_guard writing(writes_);
  if (auto gone = ExpireAll(); !gone) return gone;
  auto removed = store_.RemoveExpired(clock_.WallNow(), kSweep);
  if (!removed) return Fail(std::move(removed.error()));
  for (const store::SessionKey& key : *removed) {
    if (const Found session = InMemory(key)) Drop(session);
  }
  return {};
}

}  // namespace arap::app
