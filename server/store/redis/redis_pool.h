// RedisPool: connections to the Redis that takes writes now, which sentinels or a cluster may move.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/store/redis/redis.h"
#include "server/store/redis/redis_url.h"

namespace arap::store {

struct RedisOptions {
  RedisUrl url;
  std::string sentinel_password = {};  // empty: the sentinels ask for none
  // Replicas that have to confirm a change before it counts (WAIT).
  int replicas = 0;
  // Of all keys; no character that SCAN's patterns know (*?[\). In a cluster it stands in braces,
  // so that all keys are in one slot.
  std::string prefix = "arap:";
  std::chrono::milliseconds timeout{1'000};  // of connecting and of every command
};

// Finds the server that takes writes and connects to it. Thread-safe.
class RedisMaster {
 public:
  explicit RedisMaster(const RedisOptions& options);

  // A server is taken at its word. What sentinels name is asked for its role. In a cluster it is
  // the node that has the slot of the keys. kStoreUnavailable when there is none just now.
  Result<std::unique_ptr<RedisConnection>> Connect();

  // Whether sentinels name another server than the one that was connected to last. The first one
  // that answers decides; false when none does.
  bool HasMoved();

 private:
  using Opened = Result<std::unique_ptr<RedisConnection>>;

  Opened Open(const RedisPlace& place) const;
  Result<RedisPlace> Ask(const RedisPlace& sentinel) const;
  Opened ConnectNamed(const RedisPlace& sentinel);
  Opened ConnectOwner(RedisPlace node);
  // Where to ask: who knew it last comes first.
  std::vector<RedisPlace> Places() const;
  void Remember(const RedisPlace& asked, const RedisPlace& master);

  const RedisUrl url_;
  const RedisAccess sentinel_access_;
  const std::string key_;  // of the slot
  const std::chrono::milliseconds timeout_;
  mutable Mutex mutex_;
  std::optional<RedisPlace> asked_ ABSL_GUARDED_BY(mutex_);
  std::optional<RedisPlace> master_ ABSL_GUARDED_BY(mutex_);
};

// As many connections as there are calls at a time.
//
// Thread-safe. Connects when it has to, and again after Redis was gone or another server has become
// the master. A call that finds its connection broken, or the server no longer the master, tries
// once on a new one; so a command may have run twice.
class RedisPool {
 public:
  using Connection = std::unique_ptr<RedisConnection>;

  explicit RedisPool(const RedisOptions& options)
      : master_(options), timeout_(options.timeout), replicas_(options.replicas) {}

  // As RedisConnection::Run. After a timeout all calls fail at once for as long as it took, so
  // that callers do not queue up before a Redis that hangs.
  Result<std::vector<RedisReply>> Run(const std::vector<RedisCommand>& commands);
  // One command whose reply is no error, for that is kStoreUnavailable here.
  Result<RedisReply> Run(const RedisCommand& command);
  // Scripts that change something answer a number, 0 for no change, or a list, empty for none. A
  // change that too few replicas confirm is kStoreUnavailable: it may be there or not.
  Result<RedisReply> Run(const RedisScript& script, const std::vector<std::string>& keys,
                         const std::vector<std::string>& arguments);
  // The first command changes something, or answers nil. As above.
  Result<std::vector<RedisReply>> Change(std::vector<RedisCommand> commands);

  // A new connection that no other call uses and that is not kept.
  Result<Connection> Alone() { return Connect(); }

  // Asks the sentinels whether this is the master still.
  void Follow();

 private:
  // Idle connections that are kept.
  static constexpr std::size_t kMaxIdle = 8;

  struct Idle {
    Connection connection;
    std::uint64_t age = 0;
  };

  Idle TakeIdle();
  Status CheckAlive();
  Result<Connection> Connect();
  void Keep(Idle idle);
  // A connection broke: the others are as old and no better. Drops the idle ones now, those in use
  // when they come back.
  void Broke(bool timed_out);

  RedisMaster master_;
  const std::chrono::milliseconds timeout_;
  const int replicas_;
  Mutex mutex_;
  std::vector<Idle> idle_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t age_ ABSL_GUARDED_BY(mutex_) = 0;
  std::chrono::steady_clock::time_point dead_until_ ABSL_GUARDED_BY(mutex_){};
};

// What stands before the name of every key, and the key by which the slot of all is found.
std::string PrefixOf(const RedisOptions& options);

}  // namespace arap::store
