#include "server/store/redis/redis.h"

#include <cerrno>
#include <csignal>
#include <ctime>
#include <utility>

#include <pthread.h>

#include "core/base/try.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

using std::chrono::steady_clock;

// hiredis writes to sockets without MSG_NOSIGNAL. Keeps SIGPIPE from this thread, and swallows the
// one that came meanwhile; the handler of the process stays as it is.
class NoSigpipe {
 public:
  NoSigpipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoSigpipe() {
    const timespec none{};
    if (!was_pending_) {
      while (sigtimedwait(&pipe_, nullptr, &none) < 0 && errno == EINTR) {
      }
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
  bool was_pending_ = false;
};

timeval ToTimeval(std::chrono::milliseconds time) {
  return {time.count() / 1000, (time.count() % 1000) * 1000};
}

}  // namespace

std::string RedisReply::TextOf(const redisReply* reply) {
  if (reply->str == nullptr) return {};
  return {reply->str, reply->len};
}

std::vector<std::string> RedisReply::Texts() const {
  std::vector<std::string> texts;
  if (reply_->type != REDIS_REPLY_ARRAY) return texts;
  for (std::size_t i = 0; i < reply_->elements; ++i) texts.push_back(TextOf(reply_->element[i]));
  return texts;
}

Result<std::unique_ptr<RedisConnection>> RedisConnection::Open(const RedisUrl& url,
                                                               std::chrono::milliseconds timeout) {
  std::unique_ptr<RedisConnection> connection(new RedisConnection);
  const timeval limit = ToTimeval(timeout);
  connection->context_.reset(redisConnectWithTimeout(url.host.c_str(), url.port, limit));
  redisContext* context = connection->context_.get();
  if (context == nullptr || context->err != 0) return Fail(Unavailable("Redis cannot be reached"));
  redisEnableKeepAlive(context);
  if (redisSetTimeout(context, limit) != REDIS_OK) {
    return Fail(Unavailable("Redis cannot be reached"));
  }
  CHECK_OK(connection->Greet(url));
  return connection;
}

// Redis' own words are not passed on: they may repeat what was sent, the password too.
Status RedisConnection::Greet(const RedisUrl& url) {
  std::vector<RedisCommand> commands;
  if (!url.password.empty()) commands.push_back({"AUTH", url.password});
  if (url.database != 0) commands.push_back({"SELECT", std::to_string(url.database)});
  if (commands.empty()) return {};
  TRY(auto replies, Run(commands));
  if (!url.password.empty() && replies.front().IsError()) {
    return Fail(Unavailable("Redis does not accept the password"));
  }
  if (replies.back().IsError()) return Fail(Unavailable("Redis does not have the database"));
  return {};
}

Result<std::vector<RedisReply>> RedisConnection::Run(const std::vector<RedisCommand>& commands) {
  const NoSigpipe guard;
  redisContext* context = context_.get();
  for (const RedisCommand& command : commands) {
    std::vector<const char*> parts;
    std::vector<std::size_t> sizes;
    for (const std::string& part : command) {
      parts.push_back(part.data());
      sizes.push_back(part.size());
    }
    redisAppendCommandArgv(context, static_cast<int>(parts.size()), parts.data(), sizes.data());
  }
  std::vector<RedisReply> replies;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    void* reply = nullptr;
    if (redisGetReply(context, &reply) != REDIS_OK || reply == nullptr) {
      timed_out_ = context->err == REDIS_ERR_IO && (errno == EAGAIN || errno == EWOULDBLOCK);
      return Fail(Unavailable(timed_out_ ? "Redis does not answer in time"
                                         : "the connection to Redis broke"));
    }
    replies.emplace_back(static_cast<redisReply*>(reply));
  }
  return replies;
}

RedisPool::Connection RedisPool::TakeIdle() {
  const MutexLock lock(&mutex_);
  if (idle_.empty()) return nullptr;
  Connection connection = std::move(idle_.back());
  idle_.pop_back();
  return connection;
}

void RedisPool::Keep(Connection connection) {
  const MutexLock lock(&mutex_);
  dead_until_ = {};
  if (idle_.size() < kMaxIdle) idle_.push_back(std::move(connection));
}

void RedisPool::Broke(bool timed_out) {
  std::vector<Connection> old;
  const MutexLock lock(&mutex_);
  old.swap(idle_);
  if (timed_out) dead_until_ = steady_clock::now() + timeout_;
}

Status RedisPool::CheckAlive() {
  const MutexLock lock(&mutex_);
  if (steady_clock::now() >= dead_until_) return {};
  return Fail(Unavailable("Redis did not answer in time a moment ago"));
}

Result<RedisPool::Connection> RedisPool::Connect() {
  const auto start = steady_clock::now();
  auto connection = RedisConnection::Open(url_, timeout_);
  // Only a timeout is worth remembering; a refused connection comes back at once the next time too.
  if (!connection) Broke(steady_clock::now() - start >= timeout_);
  return connection;
}

Result<std::vector<RedisReply>> RedisPool::Run(const std::vector<RedisCommand>& commands) {
  CHECK_OK(CheckAlive());
  if (Connection connection = TakeIdle(); connection != nullptr) {
    auto replies = connection->Run(commands);
    if (replies) {
      Keep(std::move(connection));
      return replies;
    }
    Broke(connection->timed_out());
    if (connection->timed_out()) return Fail(replies.error());
  }
  TRY(auto connection, Connect());
  auto replies = connection->Run(commands);
  if (replies) {
    Keep(std::move(connection));
  } else {
    Broke(connection->timed_out());
  }
  return replies;
}

}  // namespace arap::store
