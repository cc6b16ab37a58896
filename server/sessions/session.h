// Session: a namespace of meshes and handle sets that ends when it is deleted or unused for too
// long — the record that is stored, with what only this process knows of it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/limits.h"
#include "core/base/mutex.h"
#include "server/budget/derived_cache.h"
#include "server/runtime/clock.h"
#include "server/store/store.h"

namespace arap::app {

// What a client asks for when it opens a session. Equal specs make CreateSession harmless to
// repeat.
struct SessionSpec {
  std::string id;
  std::chrono::milliseconds ttl{};  // how long it lives without use
  std::map<std::string, std::string> labels;

  bool operator==(const SessionSpec&) const = default;
};

// What a session looked like at one moment.
struct SessionView {
  std::string owner;
  SessionSpec spec;
  runtime::Clock::Wall created;
  runtime::Clock::Wall expires;
  std::vector<std::string> mesh_ids;        // ascending
  std::vector<std::string> handle_set_ids;  // ascending
};

// How much longer than it was told to live a session is stored. Its expiry moves with every use;
// the store follows with every sweep, and a crash in between must not shorten a life. Other
// processes take a session for ended half of that before the stored expiry, so the stored one is
// moved when it lags behind by half, or by a sixth where the life is short: then a sweep may be
// many seconds late before another process is misled.
inline constexpr std::chrono::milliseconds kStoredLonger = std::chrono::seconds(30);
inline constexpr std::chrono::milliseconds kShortTtl = std::chrono::seconds(60);

// Thread-safe. Records are immutable and shared: looking costs a pointer. Only the registry
// replaces them.
class Session {
 public:
  using Record = std::shared_ptr<const store::SessionRecord>;
  using Listener = std::function<void()>;

  // The memory of a record, reserved for its owner.
  using Room = DerivedCache::Reservation;

  // `clock` outlives the session. It expires at `expires` unless it is used.
  Session(Record record, Room room, runtime::Clock::Steady expires, const runtime::Clock& clock);

  const store::SessionKey& key() const { return key_; }
  Record record() const;
  void Replace(Record record, Room room);
  // Replaces it by what was read from the store; handle sets that are as they were keep their
  // lists, so that they are found to be the same without comparing handles.
  void Reload(store::SessionRecord record, Room room);
  SessionView View() const;

  // Extends the life to a ttl from now. Never blocks. kNotFound when it has ended or expired.
  Status Touch();
  bool expired() const;
  // The expiry on a clock that says `now`.
  runtime::Clock::Wall ExpiryAt(runtime::Clock::Wall now) const;
  // The expiry that should be stored, if the stored one is about to be overtaken; `now` is the
  // store's time. Then `Stored`.
  bool NeedsStoring(runtime::Clock::Wall now, runtime::Clock::Wall* expires) const;
  void Stored(runtime::Clock::Wall expires);
  // The stored expiry was moved together with the store's clock.
  void Shifted(std::chrono::milliseconds jump);
  runtime::Clock::Wall stored_expires() const;

  // Ends the session and calls the listeners once, in this thread.
  void End();
  // Calls `listener` when the session ends; at once if it has. It must not call back into the
  // session.
  std::uint64_t AddEndListener(Listener listener);
  void RemoveEndListener(std::uint64_t id);

 private:
  runtime::Clock::Wall ExpiryAtLocked(runtime::Clock::Wall now) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const store::SessionKey key_;
  const std::chrono::milliseconds ttl_;
  const runtime::Clock& clock_;

  mutable Mutex mutex_;
  Record record_ ABSL_GUARDED_BY(mutex_);
  Room room_ ABSL_GUARDED_BY(mutex_);
  runtime::Clock::Steady expires_ ABSL_GUARDED_BY(mutex_);
  runtime::Clock::Wall stored_expires_ ABSL_GUARDED_BY(mutex_);
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  std::uint64_t next_listener_ ABSL_GUARDED_BY(mutex_) = 1;
  std::map<std::uint64_t, Listener> listeners_ ABSL_GUARDED_BY(mutex_);
};

// What a record takes in memory, about.
std::size_t BytesOf(const store::SessionRecord& record);

// A part of a record. kNotFound.
Result<store::MeshRecord> FindMesh(const store::SessionRecord& record, const std::string& mesh_id);
Result<store::HandleSetRecord> FindHandleSet(const store::SessionRecord& record,
                                             const std::string& handle_set_id);
Result<store::JobRecord> FindJob(const store::SessionRecord& record, const std::string& job_id);
SessionView ViewOf(const store::SessionRecord& record, runtime::Clock::Wall expires);

// kInvalidName and kInvalidOption with the field of CreateSession.
Status CheckSpec(const SessionSpec& spec, const Limits& limits);
// kInvalidOption with the field of ListSessions.
Status CheckPage(std::size_t size, const std::string& token);

}  // namespace arap::app
