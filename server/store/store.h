// Where sessions live: their records, the interfaces of the stores for records and for blobs, and
// the faults of both.
#pragma once

#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/handle.h"
#include "server/runtime/clock.h"

namespace arap::store {

// Owners do not see each other: the same id of two owners names two sessions.
struct SessionKey {
  std::string owner;
  std::string id;

  // clang-tidy takes the zero in the generated comparison for a pointer.
  auto operator<=>(const SessionKey&) const = default;  // NOLINT(modernize-use-nullptr)
};

// A mesh with its options. `blob` is the SHA-256 of the mesh blob (mesh_blob.h) and at the same
// time the content hash.
struct MeshRecord {
  std::string blob;
};

// The handles of a set as the client gave them, after the edits so far. Immutable and shared, so
// that looking at a set copies none of them. Never null.
using HandleDefinitions = std::shared_ptr<const std::vector<Handle>>;

inline HandleDefinitions MakeDefinitions(std::vector<Handle> handles) {
  return std::make_shared<const std::vector<Handle>>(std::move(handles));
}

// Whether two lists describe the same handles in the same order. A list is compared with itself by
// its address.
inline bool SameDefinitions(const HandleDefinitions& a, const HandleDefinitions& b) {
  return a == b || *a == *b;
}

struct HandleSetRecord {
  std::string mesh_id;
  HandleDefinitions definitions = MakeDefinitions({});
  std::uint64_t revision = 1;  // grows by one with every edit
};

struct SessionRecord {
  SessionKey key;
  std::chrono::milliseconds ttl{};
  std::map<std::string, std::string> labels;
  runtime::Clock::Wall created;              // whole milliseconds
  runtime::Clock::Wall expires;              // likewise; no earlier than what the client was told
  std::map<std::string, MeshRecord> meshes;  // by mesh id
  std::map<std::string, HandleSetRecord> handle_sets;  // by handle set id
  std::uint64_t revision = 1;  // grows by one with every change but that of `expires`
};

// How much an owner has.
struct Usage {
  std::size_t sessions = 0;
  std::size_t meshes = 0;
  std::size_t handle_sets = 0;
};

// Thread-safe; calls may block on disk or network, so they belong on no interactive lane. What was
// changed is durable when a call returns, as far as the store promises durability. Every call may
// fail with kStoreUnavailable (cannot be reached, cannot write; detail "why"). Nothing was changed
// then, except that a network may break after the change and before the answer: read again. The
// next call tries anew. Load fails with kDataLoss for a record that cannot be read (details "owner"
// and "session"); its key is taken until it expires or is removed.
class SpecStore {
 public:
  virtual ~SpecStore() = default;

  // The record, expired or not; nothing when there is none.
  virtual Result<std::optional<SessionRecord>> Load(const SessionKey& key) = 0;
  // Its revision alone; cheaper than Load.
  virtual Result<std::optional<std::uint64_t>> Revision(const SessionKey& key) = 0;

  // With revision 1 adds the record, else puts it in the place of its revision − 1. False when that
  // is not what is stored: somebody else was first.
  virtual Result<bool> Put(const SessionRecord& record) = 0;
  // Moves the expiry alone. False when there is no such session.
  virtual Result<bool> Extend(const SessionKey& key, runtime::Clock::Wall expires) = 0;
  // False when there was none.
  virtual Result<bool> Remove(const SessionKey& key) = 0;

  // At most `limit` records after the id `after`, by id; fewer only at the end. Records that cannot
  // be read are left out.
  virtual Result<std::vector<SessionRecord>> List(const std::string& owner,
                                                  const std::string& after, std::size_t limit) = 0;
  // The owners that have sessions, ascending.
  virtual Result<std::vector<std::string>> Owners() = 0;
  virtual Result<Usage> UsageOf(const std::string& owner) = 0;
  // Sessions of all owners.
  virtual Result<std::size_t> Count() = 0;

  // Removes at most `limit` sessions whose expiry is not after `now`, and names them.
  virtual Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                        std::size_t limit) = 0;
  // The blobs that records name.
  virtual Result<std::set<std::string>> ReferencedBlobs() = 0;

  // Whether other processes may change the records too.
  virtual bool shared() const = 0;
  // Fails while the store cannot serve. Cheap.
  virtual Status Probe() = 0;
};

// What a store did about a database that it found damaged.
struct Recovery {
  std::string kept_as;    // where the damaged database lies now
  std::size_t saved = 0;  // records that were carried over
  // Records that could not be read. As far as their keys are known their sessions answer kDataLoss
  // until they expire or are removed.
  std::size_t lost = 0;
  bool complete = false;  // false: there may have been records that left no trace
};

struct SweepReport {
  std::size_t removed = 0;
  std::size_t removed_bytes = 0;
  std::size_t kept = 0;
  std::size_t kept_bytes = 0;
};

// Thread-safe; calls may block on disk. Faults as in SpecStore: kStoreUnavailable, kDataLoss.
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  // Durable when it returns. `hash` is the SHA-256 of `bytes`. A blob that is there already is as
  // young afterwards as a new one.
  virtual Status Put(const std::string& hash, std::string_view bytes) = 0;
  // kDataLoss when it is missing or no longer what its name says; details "blob" and "why".
  virtual Result<std::string> Get(const std::string& hash) = 0;
  // Removes blobs that are not in `referenced` and older than `age`: a younger one may belong to a
  // record that is about to be written. Also what interrupted writes left behind.
  virtual Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                                    std::chrono::seconds age) = 0;
};

// Times as they are stored: milliseconds since 1970, rounded up: what expires never does so earlier
// for being stored.
std::int64_t ToMillis(runtime::Clock::Wall time);
runtime::Clock::Wall FromMillis(std::int64_t millis);

// The sentences of these reach clients: no path, no address, no password in them.

// kStoreUnavailable; detail "why".
Fault Unavailable(std::string_view why);
// Because of errno, which is `number`.
Fault UnavailableErrno(int number);

// kDataLoss of a record; details "owner" and "session".
Fault LostRecord(const SessionKey& key);
// kDataLoss of a blob; details "blob" and "why": "missing" or "damaged".
Fault LostBlob(const std::string& hash, std::string_view why);

}  // namespace arap::store
