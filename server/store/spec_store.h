// SpecStore: where session records live.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "server/runtime/clock.h"
#include "server/store/session_record.h"

namespace arap::store {

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

}  // namespace arap::store
