// RedisSpecStore: records in Redis, for many replicas.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "server/store/redis/redis_pool.h"
#include "server/store/redis/redis_scripts.h"
#include "server/store/store.h"

namespace arap::store {

// As durable as Redis is configured to be (appendonly, appendfsync); it must not evict keys
// (maxmemory-policy noeviction). Facts says so when it is not. While it is gone calls fail at once,
// while it hangs within RedisOptions::timeout; afterwards the next call works. When a connection
// breaks in the middle of a call and no new one can be had, whether something was changed is not
// known.
//
// Redis answers before its replicas have a change. With RedisOptions::replicas a call that changes
// something returns when so many have it; what fewer have is a fault, and may be there or not. In a
// cluster all keys are in one slot, that is on one node and its replicas: a cluster takes over like
// sentinels do, and holds no more than one of its nodes. While that slot is being moved calls fail.
class RedisSpecStore : public SpecStore {
 public:
  // Connects at the first call.
  explicit RedisSpecStore(const RedisOptions& options);

  Result<std::optional<SessionRecord>> Load(const SessionKey& key) override;
  Result<std::optional<RecordVersion>> Version(const SessionKey& key) override;
  Result<bool> Put(const SessionRecord& record) override;
  Result<bool> Extend(const SessionKey& key, const std::string& incarnation,
                      runtime::Clock::Wall expires) override;
  Result<bool> Remove(const SessionKey& key) override;
  Result<bool> RemoveAsOf(const SessionKey& key, runtime::Clock::Wall expires) override;
  Result<std::vector<SessionRecord>> List(const std::string& owner, const std::string& after,
                                          std::size_t limit) override;
  Result<std::vector<std::string>> Owners() override;
  Result<Usage> UsageOf(const std::string& owner) override;
  Result<Usage> UsageUnder(const std::string& owner) override;
  Result<std::size_t> Count() override;
  Result<std::vector<SessionKey>> RemoveExpired(runtime::Clock::Wall now,
                                                std::size_t limit) override;
  Status Shift(std::chrono::milliseconds) override { return {}; }
  Result<std::set<std::string>> ReferencedBlobs() override;
  Result<std::optional<runtime::Clock::Wall>> Time() override;
  Result<StoreFacts> Facts() override;
  bool shared() const override { return true; }
  Status Probe() override;

 private:
  std::string Key(const std::string& name) const { return prefix_ + name; }
  // session, ids, counts, owners, expiry
  std::vector<std::string> KeysOf(const SessionKey& key) const;
  std::string NewToken();
  // With an empty `expires` whatever the expiry is.
  Result<bool> Remove(const SessionKey& key, std::string expires);

  const std::string prefix_;
  const bool fails_over_;  // another server may become the master
  const int replicas_;
  const std::string writer_;  // no other store has it
  std::atomic<std::uint64_t> writes_{0};
  const RedisScripts scripts_;
  RedisPool pool_;
};

}  // namespace arap::store
