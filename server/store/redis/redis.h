// Redis as this server speaks to it: where it is, a reply, a script, one connection of hiredis, and
// a pool of them.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <hiredis/hiredis.h>

#include "arap/base/result.h"
#include "core/base/mutex.h"

namespace arap::store {

// redis://[:PASSWORD@]HOST[:PORT][/DB].
struct RedisUrl {
  std::string host;  // without the brackets of an IPv6 address
  int port = 6379;
  std::string password;  // empty: none
  int database = 0;
};

// %XX stands for a byte of the password. kInvalidOption with the field "store"; the password is
// not in it.
Result<RedisUrl> ParseRedisUrl(const std::string& url);

// For showing: the password as ***.
std::string WithoutPassword(const std::string& url);

// What Redis answered, with accessors that take nothing for granted. Owns its parts; movable.
class RedisReply {
 public:
  explicit RedisReply(redisReply* reply) : reply_(reply) {}

  bool IsNil() const { return reply_->type == REDIS_REPLY_NIL; }
  bool IsError() const { return reply_->type == REDIS_REPLY_ERROR; }
  // 0 for anything but a number, empty for anything but a string, a status or an error.
  std::int64_t Int() const { return reply_->type == REDIS_REPLY_INTEGER ? reply_->integer : 0; }
  std::string Text() const { return TextOf(reply_.get()); }
  // Of an array, nils and foreign elements empty; nothing for anything else.
  std::vector<std::string> Texts() const;

 private:
  struct Free {
    void operator()(redisReply* reply) const { freeReplyObject(reply); }
  };
  static std::string TextOf(const redisReply* reply);

  std::unique_ptr<redisReply, Free> reply_;
};

using RedisCommand = std::vector<std::string>;

// Lua that Redis runs in one step; no other command comes between.
struct RedisScript {
  explicit RedisScript(std::string the_text);

  std::string text;
  std::string sha1;  // the name that Redis has for it; empty if it could not be computed
};

// One connection. Not thread-safe. Sends no SIGPIPE when the peer is gone.
class RedisConnection {
 public:
  // Connects, authenticates, selects. kStoreUnavailable after at most `timeout` per step.
  static Result<std::unique_ptr<RedisConnection>> Open(const RedisUrl& url,
                                                       std::chrono::milliseconds timeout);

  // Sends all commands at once and waits for the answers, in their order. kStoreUnavailable when
  // the connection broke: it is not to be used again then. Error replies are values here.
  Result<std::vector<RedisReply>> Run(const std::vector<RedisCommand>& commands);

  // Whether the break was a timeout: the server is there but does not answer.
  bool timed_out() const { return timed_out_; }

 private:
  struct Free {
    void operator()(redisContext* context) const { redisFree(context); }
  };
  RedisConnection() = default;
  Status Greet(const RedisUrl& url);

  std::unique_ptr<redisContext, Free> context_;
  bool timed_out_ = false;
};

// kStoreUnavailable, naming an error reply by its first word: the rest may repeat what was sent.
Fault FaultOf(const RedisReply& error);

// Connections to one Redis, as many as there are calls at a time.
//
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
  // One command whose reply is no error, for that is kStoreUnavailable here.
  Result<RedisReply> Run(const RedisCommand& command);
  Result<RedisReply> Run(const RedisScript& script, const std::vector<std::string>& keys,
                         const std::vector<std::string>& arguments);

 private:
  using Connection = std::unique_ptr<RedisConnection>;

  // Idle connections that are kept.
  static constexpr std::size_t kMaxIdle = 8;

  Connection TakeIdle();
  Status CheckAlive();
  Result<Connection> Connect();
  void Keep(Connection connection);
  // A connection broke: drops the idle ones, which are as old and no better.
  void Broke(bool timed_out);

  const RedisUrl url_;
  const std::chrono::milliseconds timeout_;
  Mutex mutex_;
  std::vector<Connection> idle_ ABSL_GUARDED_BY(mutex_);
  std::chrono::steady_clock::time_point dead_until_ ABSL_GUARDED_BY(mutex_){};
};

}  // namespace arap::store
