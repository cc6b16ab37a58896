// RedisPool: connections to one Redis, as many as there are calls at a time.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <vector>

#include "arap/base/result.h"
#include "server/store/redis/redis.h"
#include "server/store/redis/redis_url.h"

namespace arap::store {

// Thread-safe. Connects when it has to, and again after Redis was gone. A call that finds its
// connection broken tries once on a new one; so a command may have run twice.
class RedisPool {
 public:
  // `timeout` bounds connecting and every command.
  RedisPool(RedisUrl url, std::chrono::milliseconds timeout)
      : url_(std::move(url)), timeout_(timeout) {}

  // As RedisConnection::Run. After a timeout all calls fail at once for as long as it took, so
  // that callers do not queue up before a Redis that hangs.
  Result<std::vector<RedisReply>> Run(const std::vector<RedisCommand>& commands);

 private:
  using Connection = std::unique_ptr<RedisConnection>;

  // Kept when nobody uses them.
  static constexpr std::size_t kMaxIdle = 8;

  Connection TakeIdle();
  Status CheckAlive();
  Result<Connection> Connect();
  void Keep(Connection connection);
  // A connection broke: the others of its age are no better.
  void Broke(bool timed_out);

  const RedisUrl url_;
  const std::chrono::milliseconds timeout_;
  std::mutex mutex_;
  std::vector<Connection> idle_;                        // guarded by mutex_
  std::chrono::steady_clock::time_point dead_until_{};  // guarded by mutex_
};

}  // namespace arap::store
