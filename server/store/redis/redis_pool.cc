#include "server/store/redis/redis_pool.h"

#include <utility>

#include "server/store/store_fault.h"

namespace arap::store {

using std::chrono::steady_clock;

RedisPool::Connection RedisPool::TakeIdle() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return nullptr;
  Connection connection = std::move(idle_.back());
  idle_.pop_back();
  return connection;
}

void RedisPool::Keep(Connection connection) {
  const std::lock_guard lock(mutex_);
  dead_until_ = {};
  if (idle_.size() < kMaxIdle) idle_.push_back(std::move(connection));
}

void RedisPool::Broke(bool timed_out) {
  std::vector<Connection> old;
  const std::lock_guard lock(mutex_);
  old.swap(idle_);
  if (timed_out) dead_until_ = steady_clock::now() + timeout_;
}

Status RedisPool::CheckAlive() {
  const std::lock_guard lock(mutex_);
  if (steady_clock::now() >= dead_until_) return {};
  return Fail(Unavailable("Redis did not answer in time a moment ago"));
}

Result<RedisPool::Connection> RedisPool::Connect() {
  const auto start = steady_clock::now();
  auto connection = RedisConnection::Open(url_, timeout_);
  // A refusal comes at once and costs nothing to ask for again.
  if (!connection) Broke(steady_clock::now() - start >= timeout_);
  return connection;
}

Result<std::vector<RedisReply>> RedisPool::Run(const std::vector<RedisCommand>& commands) {
  if (auto alive = CheckAlive(); !alive) return Fail(alive.error());
  if (Connection connection = TakeIdle(); connection != nullptr) {
    auto replies = connection->Run(commands);
    if (replies) {
      Keep(std::move(connection));
      return replies;
    }
    Broke(connection->timed_out());
    if (connection->timed_out()) return Fail(replies.error());
  }
  auto connection = Connect();
  if (!connection) return Fail(connection.error());
  auto replies = (*connection)->Run(commands);
  if (replies) {
    Keep(*std::move(connection));
  } else {
    Broke((*connection)->timed_out());
  }
  return replies;
}

}  // namespace arap::store
