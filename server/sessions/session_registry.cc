#include "server/sessions/session_registry.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/budget/faults.h"

namespace arap::app {
namespace {

using std::chrono::milliseconds;

// Expired records that one sweep removes at most.
constexpr std::size_t kSweep = 1'000;
constexpr std::size_t kIncarnationDigits = 16;
constexpr std::size_t kDefaultPageSize = 100;
// How often a change is tried that another process forestalls.
constexpr int kChangeTries = 16;

runtime::Clock::Wall WholeMilliseconds(runtime::Clock::Wall time) {
  return std::chrono::time_point_cast<milliseconds>(time);
}

// What a change adds, for the quotas of its owner.
store::Usage Added(const store::SessionRecord& before, const store::SessionRecord& after) {
  const auto more = [](std::size_t now, std::size_t then) { return now > then ? now - then : 0; };
  return {.meshes = more(after.meshes.size(), before.meshes.size()),
          .handle_sets = more(after.handle_sets.size(), before.handle_sets.size()),
          .bytes = more(after.BlobBytes(), before.BlobBytes())};
}

}  // namespace

SessionRegistry::SessionRegistry(const Limits& limits, const runtime::Clock& clock,
                                 store::SpecStore& store, DerivedCache& memory,
                                 std::function<void(const store::SessionRecord&)> released)
    : limits_(limits),
      clock_(clock),
      store_(store),
      memory_(memory),
      time_(store, clock),
      released_(std::move(released)),
      quotas_(limits, store) {}

SessionRegistry::Found SessionRegistry::InMemory(const store::SessionKey& key) const {
  const MutexLock lock(&mutex_);
  const auto found = sessions_.find(key);
  return found == sessions_.end() ? nullptr : found->second;
}

std::vector<SessionRegistry::Found> SessionRegistry::InMemory(
    const std::function<bool(const Session&)>& wanted) const {
  const MutexLock lock(&mutex_);
  std::vector<Found> found;
  for (const auto& [key, session] : sessions_) {
    if (wanted(*session)) found.push_back(session);
  }
  return found;
}

std::size_t SessionRegistry::in_memory() const {
  const MutexLock lock(&mutex_);
  return sessions_.size();
}

std::size_t SessionRegistry::bytes() const {
  const MutexLock lock(&mutex_);
  std::size_t bytes = 0;
  for (const auto& [key, session] : sessions_) bytes += BytesOf(*session->record());
  return bytes;
}

void SessionRegistry::Drop(const Held&, const Found& session) {
  {
    const MutexLock lock(&mutex_);
    const auto found = sessions_.find(session->key());
    if (found == sessions_.end() || found->second != session) return;
    sessions_.erase(found);
  }
  session->End();
  released_(*session->record());
}

Status SessionRegistry::Expire(const Held& held, const Found& session) {
  // The id may have been freed and taken anew meanwhile.
  if (InMemory(session->key()) != session) return {};
  // Not what another process has extended meanwhile.
  if (auto removed = store_.RemoveAsOf(session->key(), session->stored_expires()); !removed) {
    return Fail(removed.error());
  }
  Drop(held, session);
  return {};
}

Status SessionRegistry::ExpireAll(const std::string* owner, Busy busy) {
  const auto expired = [owner](const Session& session) {
    return session.expired() && (owner == nullptr || session.key().owner == *owner);
  };
  for (const Found& session : InMemory(expired)) {
    if (busy == Busy::kWait) {
      CHECK_OK(Expire(locks_.Take(session->key()), session));
    } else if (const auto held = locks_.TryTake(session->key())) {
      CHECK_OK(Expire(*held, session));
    }
  }
  return {};
}

Result<bool> SessionRegistry::IsCurrent(const Session& session) {
  if (!store_.shared()) return true;
  TRY(const auto version, store_.Version(session.key()));
  return version && *version == store::VersionOf(*session.record());
}

Result<SessionRegistry::Found> SessionRegistry::Find(const store::SessionKey& key) {
  if (Found session = InMemory(key); session && !session->expired()) {
    TRY(const bool current, IsCurrent(*session));
    if (current) return session;
  }
  return Find(locks_.Take(key), key);
}

Result<SessionRegistry::Found> SessionRegistry::Find(const Held& held,
                                                     const store::SessionKey& key) {
  Found session = InMemory(key);
  if (session && session->expired()) {
    CHECK_OK(Expire(held, session));
    if (!store_.shared()) return Fail(NotFound("session", key.id));
    session = nullptr;
  }
  if (session) {
    TRY(const bool current, IsCurrent(*session));
    if (current) return session;
  }
  return Load(held, key, std::move(session));
}

Result<SessionRegistry::Found> SessionRegistry::Load(const Held& held, const store::SessionKey& key,
                                                     Found session) {
  CHECK_OK(time_.Refresh());
  TRY(auto loaded, store_.Load(key));
  // Stored longer than told, and the store may lag behind by half of that.
  const auto now = time_.Now();
  const auto expires = loaded ? loaded->expires - kStoredLonger / 2 : now;
  if (now >= expires) {
    if (session) Drop(held, session);
    if (loaded) CHECK_OK(store_.RemoveAsOf(key, loaded->expires));
    return Fail(NotFound("session", key.id));
  }
  // Another process has ended the session and opened another one under its id.
  if (session && session->record()->incarnation != loaded->incarnation) {
    Drop(held, session);
    session = nullptr;
  }
  auto room = memory_.Hold(key.owner, BytesOf(*loaded));
  if (session) {
    session->Reload(*std::move(loaded), std::move(room));
    return session;
  }
  session =
      std::make_shared<Session>(std::make_shared<const store::SessionRecord>(*std::move(loaded)),
                                std::move(room), clock_.SteadyNow() + (expires - now), clock_);
  const MutexLock lock(&mutex_);
  return sessions_.emplace(key, std::move(session)).first->second;
}

Result<SessionView> SessionRegistry::Create(const Caller& caller, SessionSpec spec) {
  if (spec.ttl == milliseconds::zero()) spec.ttl = limits_.default_ttl;
  CHECK_OK(CheckSpec(spec, limits_));
  const store::SessionKey key{caller.owner, spec.id};
  auto view = Create(locks_.Take(key), caller, spec);
  if (view || view.error().kind != FaultKind::kLimitExceeded) return view;
  // Sessions that have expired may hold the places.
  CHECK_OK(ExpireAll(nullptr, Busy::kWait));
  return Create(locks_.Take(key), caller, spec);
}

Result<SessionView> SessionRegistry::Create(const Held& held, const Caller& caller,
                                            const SessionSpec& spec) {
  const store::SessionKey key{caller.owner, spec.id};
  const auto found = Find(held, key);
  if (found) {
    if ((*found)->View().spec == spec && (*found)->Touch()) return (*found)->View();
    return Fail(Taken("session", spec.id, "another ttl or other labels"));
  }
  if (found.error().kind != FaultKind::kNotFound) return Fail(found.error());
  TRY(const OwnerQuotas::Place place, quotas_.Take(caller, {.sessions = 1}));

  CHECK_OK(time_.Refresh());
  auto record = std::make_shared<store::SessionRecord>();
  record->key = key;
  TRY(record->incarnation, RandomHex(kIncarnationDigits));
  record->ttl = spec.ttl;
  record->labels = spec.labels;
  record->created = WholeMilliseconds(time_.Now());
  record->expires = record->created + record->ttl + kStoredLonger;
  TRY(const bool put, store_.Put(*record));
  if (!put) {
    return Fail(FaultKind::kStoreUnavailable,
                fmt::format("Another server takes the session id {} just now.", Quote(key.id)));
  }
  auto session = std::make_shared<Session>(record, memory_.Hold(key.owner, BytesOf(*record)),
                                           clock_.SteadyNow() + record->ttl, clock_);
  {
    const MutexLock lock(&mutex_);
    sessions_[key] = session;
  }
  return session->View();
}

Result<std::shared_ptr<Session>> SessionRegistry::Use(const std::string& owner,
                                                      const std::string& id) {
  TRY(auto session, Find({owner, id}));
  CHECK_OK(session->Touch());
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
  CHECK_OK(CheckPage(size, token));
  if (size == 0) size = kDefaultPageSize;
  CHECK_OK(ExpireAll(&owner, Busy::kSkip));
  TRY(auto records, store_.List(owner, token, size + 1));
  SessionPage page;
  if (records.size() > size) {
    records.resize(size);
    page.next_token = records.back().key.id;
  }
  const auto now = time_.Now();
  const auto wall = clock_.WallNow();
  for (store::SessionRecord& record : records) {
    const Found session = InMemory(record.key);
    const auto expires = record.expires - kStoredLonger / 2;
    if (session ? session->expired() : now >= expires) continue;
    // A page may have 16,000 labels, which are not to be copied more often than they must.
    auto labels = std::exchange(record.labels, {});
    page.sessions.push_back(ViewOf(record, session ? session->ExpiryAt(wall) : expires));
    page.sessions.back().spec.labels = std::move(labels);
  }
  return page;
}

Status SessionRegistry::Delete(const std::string& owner, const std::string& id) {
  const store::SessionKey key{owner, id};
  const Held held = locks_.Take(key);
  const auto session = Find(held, key);
  // What cannot be read can still be deleted.
  const bool unreadable = !session && session.error().kind == FaultKind::kDataLoss;
  if (!session && !unreadable) return Fail(session.error());
  TRY(const bool removed, store_.Remove(key));
  if (const Found known = unreadable ? InMemory(key) : *session) Drop(held, known);
  if (!unreadable && !removed) return Fail(NotFound("session", id));
  return {};
}

Result<Session::Room> SessionRegistry::RoomFor(const Caller& caller,
                                               const store::SessionRecord& before,
                                               const store::SessionRecord& after) {
  const std::size_t bytes = BytesOf(after);
  // Whoever makes it smaller is not refused.
  if (bytes <= BytesOf(before)) return memory_.Hold(before.key.owner, bytes);
  return memory_.Reserve(caller, bytes);
}

Result<Session::Record> SessionRegistry::Change(const Caller& caller, Session& session,
                                                const Edit& edit) {
  const Held held = locks_.Take(session.key());
  for (int tries = 0; tries < kChangeTries; ++tries) {
    CHECK_OK(session.Touch());
    const Session::Record before = session.record();
    auto after = std::make_shared<store::SessionRecord>(*before);
    TRY(const bool changed, edit(*after));
    if (!changed) return before;
    TRY(const OwnerQuotas::Place place, quotas_.Take(caller, Added(*before, *after)));
    TRY(auto room, RoomFor(caller, *before, *after));
    ++after->revision;
    after->expires =
        WholeMilliseconds(std::max(before->expires, session.ExpiryAt(time_.Now()) + kStoredLonger));
    TRY(const bool put, store_.Put(*after));
    if (put) {
      session.Replace(after, std::move(room));
      return after;
    }
    // Another process changed or removed it.
    TRY(auto now, store_.Load(session.key()));
    if (!now || now->incarnation != before->incarnation) {
      if (const Found ours = InMemory(session.key()); ours.get() == &session) Drop(held, ours);
      return Fail(NotFound("session", session.key().id));
    }
    room = memory_.Hold(session.key().owner, BytesOf(*now));
    session.Reload(*std::move(now), std::move(room));
  }
  return Fail(Fault(FaultKind::kStoreUnavailable,
                    fmt::format("Other servers change the session {} faster than this one can; {} "
                                "tries were in vain.",
                                Quote(session.key().id), kChangeTries))
                  .Detail("tries", kChangeTries));
}

Status SessionRegistry::MayStore(const Caller& caller, const store::Usage& more) {
  CHECK_OK(quotas_.Take(caller, more));
  return {};
}

bool SessionRegistry::InUse(const std::string& owner, const std::string& blob) const {
  const MutexLock lock(&mutex_);
  for (auto at = sessions_.lower_bound({owner, ""});
       at != sessions_.end() && at->first.owner == owner; ++at) {
    const Session::Record record = at->second->record();
    for (const auto& [id, mesh] : record->meshes) {
      if (mesh.blob == blob) return true;
    }
  }
  return false;
}

Status SessionRegistry::StoreExpiry(const Held& held, const Found& session) {
  runtime::Clock::Wall expires;
  if (InMemory(session->key()) != session || !session->NeedsStoring(time_.Now(), &expires)) {
    return {};
  }
  TRY(const bool there, store_.Extend(session->key(), session->record()->incarnation, expires));
  if (there) {
    session->Stored(expires);
  } else {
    Drop(held, session);  // another server deleted it: its streams end here too
  }
  return {};
}

Status SessionRegistry::FollowClock() {
  CHECK_OK(time_.Refresh());
  const milliseconds jump = time_.Jump();
  if (jump == milliseconds::zero()) return {};
  CHECK_OK(store_.Shift(jump));
  for (const Found& session : InMemory([](const Session&) { return true; })) session->Shifted(jump);
  time_.Adopt(jump);
  return {};
}

Status SessionRegistry::Sweep() {
  CHECK_OK(FollowClock());
  const auto now = time_.Now();
  const auto moved = [now](const Session& session) {
    runtime::Clock::Wall expires;
    return session.NeedsStoring(now, &expires);
  };
  for (const Found& session : InMemory(moved)) {
    if (const auto held = locks_.TryTake(session->key())) CHECK_OK(StoreExpiry(*held, session));
  }
  CHECK_OK(ExpireAll(nullptr, Busy::kSkip));
  TRY(const auto removed, store_.RemoveExpired(time_.Now(), kSweep));
  for (const store::SessionKey& key : removed) {
    if (InMemory(key) == nullptr) continue;
    const auto held = locks_.TryTake(key);
    if (!held) continue;
    // The id may have been taken anew meanwhile.
    TRY(const auto version, store_.Version(key));
    if (const Found session = InMemory(key); session && !version) Drop(*held, session);
  }
  return {};
}

}  // namespace arap::app
