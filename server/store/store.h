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

// A mesh with its options. `blob` is the SHA-256 of the mesh blob (server/sessions/meshes.h) and at
// the same time the content hash.
struct MeshRecord {
  std::string blob;
  std::uint64_t bytes = 0;  // of the blob; 0 where an earlier version has not written it down
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

// A flattening that is done as a job. It has ended when there is a result or a fault.
struct JobRecord {
  std::string request;  // a blob
  std::uint64_t request_bytes = 0;
  std::string result;  // a blob, when it is done
  std::uint64_t result_bytes = 0;
  std::optional<Fault> fault;  // why there is no result
};

struct SessionRecord {
  SessionKey key;
  // Tells sessions apart that had the id one after the other: random digits, made when the session
  // is. Empty in what earlier versions wrote.
  std::string incarnation;
  std::chrono::milliseconds ttl{};
  std::map<std::string, std::string> labels;
  runtime::Clock::Wall created;              // whole milliseconds
  runtime::Clock::Wall expires;              // likewise; no earlier than what the client was told
  std::map<std::string, MeshRecord> meshes;  // by mesh id
  std::map<std::string, HandleSetRecord> handle_sets;  // by handle set id
  std::map<std::string, JobRecord> jobs;               // by job id
  std::uint64_t revision = 1;  // grows by one with every change but that of `expires`

  // The blobs that it names, and their bytes; one that is named twice counts twice.
  std::set<std::string> Blobs() const;
  std::size_t BlobBytes() const;
};

// Two records of one key with equal versions are the same record.
struct RecordVersion {
  std::string incarnation;
  std::uint64_t revision = 0;

  bool operator==(const RecordVersion&) const = default;
};

inline RecordVersion VersionOf(const SessionRecord& record) {
  return {record.incarnation, record.revision};
}

// How much an owner has.
struct Usage {
  std::size_t sessions = 0;
  std::size_t meshes = 0;
  std::size_t handle_sets = 0;
  // Of the records, and of the blobs that they name; a blob that several sessions name counts for
  // each.
  std::size_t bytes = 0;

  Usage& operator+=(const Usage& more) {
    sessions += more.sessions;
    meshes += more.meshes;
    handle_sets += more.handle_sets;
    bytes += more.bytes;
    return *this;
  }
};

// Why a store may lose what it has acknowledged, or why something is wrong with it otherwise.
struct Weakness {
  const char* reason;    // for metrics: one of kWeaknesses
  std::string sentence;  // for people; no address and no password in it
  bool grave = false;    // new work should not come to this server
};

// Every reason that a Weakness may have.
inline constexpr const char* kWeaknesses[] = {"evicts",       "forgets",    "flushes_rarely",
                                              "unreplicated", "clock_skew", "foreign_blobs",
                                              "mass_removal"};

// What a store says of itself.
struct StoreFacts {
  // Random digits, made once and kept in the store: no other store has them, and an emptied one has
  // others.
  std::string id;
  std::vector<Weakness> weaknesses;
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
  // Its version alone; cheaper than Load.
  virtual Result<std::optional<RecordVersion>> Version(const SessionKey& key) = 0;

  // With revision 1 adds the record, else puts it in the place of its revision − 1 of the same
  // incarnation. False when that is not what is stored: somebody else was first.
  virtual Result<bool> Put(const SessionRecord& record) = 0;
  // Moves the expiry alone. False when there is no such session of this incarnation.
  virtual Result<bool> Extend(const SessionKey& key, const std::string& incarnation,
                              runtime::Clock::Wall expires) = 0;
  // False when there was none.
  virtual Result<bool> Remove(const SessionKey& key) = 0;
  // Removes the session if its expiry is still this one, which nobody has moved meanwhile. False
  // when there is none or it has moved.
  virtual Result<bool> RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) = 0;

  // At most `limit` records after the id `after`, by id; fewer only at the end. Records that cannot
  // be read are left out.
  virtual Result<std::vector<SessionRecord>> List(const std::string& owner,
                                                  const std::string& after, std::size_t limit) = 0;
  // The owners that have sessions, ascending.
  virtual Result<std::vector<std::string>> Owners() = 0;
  virtual Result<Usage> UsageOf(const std::string& owner) = 0;
  // Of the owner and of those whose names begin with its own and a slash. Costs a look at each.
  virtual Result<Usage> UsageUnder(const std::string& owner) = 0;
  // Sessions of all owners.
  virtual Result<std::size_t> Count() = 0;

  // Removes at most `limit` sessions whose expiry is not after `now`, nor after the time of the
  // store's own clock if it has one, and names them.
  virtual Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                        std::size_t limit) = 0;
  // Moves all expiries: the clock of this machine, which is the store's, was set. Does nothing in a
  // store with a clock of its own.
  virtual Status Shift(std::chrono::milliseconds by) = 0;
  // The blobs that records name.
  virtual Result<std::set<std::string>> ReferencedBlobs() = 0;

  // The time by the store's own clock; nothing for a store that has that of this machine.
  virtual Result<std::optional<runtime::Clock::Wall>> Time() = 0;
  // What it says of itself. Gives the store its id when it has none.
  virtual Result<StoreFacts> Facts() = 0;
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

// Which blobs a sweep may take away. Those that no record names go in two steps: they are set aside
// first, from where Get brings them back, and removed later.
struct SweepRules {
  // Younger ones stay: one may belong to a record that is about to be written.
  std::chrono::seconds age;
  // How long they lie aside.
  std::chrono::seconds aside;
  // More than this share of all blobs, if it is more than `few`, is set aside by no sweep: that
  // many are rather missed by mistake.
  double share = 1;
  std::size_t few = 0;
};

struct SweepReport {
  std::size_t removed = 0;
  std::size_t removed_bytes = 0;
  std::size_t kept = 0;  // in their places
  std::size_t kept_bytes = 0;
  std::size_t aside = 0;      // set aside, by this sweep or an earlier one
  std::size_t held_back = 0;  // kept because they were too many; part of `kept`
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
  // Takes away blobs that are not in `referenced`, and what interrupted writes left behind.
  virtual Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                                    const SweepRules& rules) = 0;
  // Makes the blobs those of the store with this id, unless they are another's: kInvalidOption with
  // the field "blob_dir".
  virtual Status Claim(const std::string& store_id) = 0;
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
