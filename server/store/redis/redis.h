// One connection to a Redis server: what is said, what it answers, a script.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <hiredis/hiredis.h>
#include <openssl/types.h>

#include "arap/base/result.h"
#include "server/store/redis/redis_url.h"

namespace arap::store {

// What Redis answered, with accessors that take nothing for granted. Owns its parts; movable.
class RedisReply {
 public:
  explicit RedisReply(redisReply* reply) : reply_(reply) {}

  bool IsError() const { return reply_->type == REDIS_REPLY_ERROR; }
  // Whether it is an error whose first word is this.
  bool IsError(std::string_view word) const;
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

// Whether the files can be used. kInvalidOption with the field "redis_ca", "redis_cert" or
// "redis_key"; names the file.
Status CheckTls(const RedisTls& files);

// One connection. Not thread-safe. Sends no SIGPIPE when the peer is gone.
//
// With TLS (1.2 at least) the certificate of the server has to name the host or the IP address that
// was connected to. hiredis of Debian 12 knows no TLS: its reader and its socket are used, OpenSSL
// stands between them.
class RedisConnection {
 public:
  // Connects, authenticates, selects. kStoreUnavailable after at most `timeout` per step.
  static Result<std::unique_ptr<RedisConnection>> Open(const RedisPlace& place,
                                                       const RedisAccess& access,
                                                       std::chrono::milliseconds timeout);

  // Sends all commands at once and waits for the answers, in their order. kStoreUnavailable when
  // the connection broke: it is not to be used again then. Error replies are values here.
  Result<std::vector<RedisReply>> Run(const std::vector<RedisCommand>& commands);
  // One command whose reply is no error, for that is kStoreUnavailable here.
  Result<RedisReply> Run(const RedisCommand& command);

  // Whether the break was a timeout: the server is there but does not answer.
  bool timed_out() const { return timed_out_; }

 private:
  struct Free {
    void operator()(redisContext* context) const { redisFree(context); }
    void operator()(SSL* tls) const;
  };
  RedisConnection() = default;
  Status Secure(const RedisTls& files, const std::string& host);
  Status Greet(const RedisAccess& access);
  bool Send(const std::vector<RedisCommand>& commands);
  bool Receive(void** reply);
  bool ReadTls();

  std::unique_ptr<redisContext, Free> context_;
  std::unique_ptr<SSL, Free> tls_;  // on the socket of the context
  bool timed_out_ = false;
};

// kStoreUnavailable, naming an error reply by its first word: the rest may repeat what was sent.
Fault FaultOf(const RedisReply& error);

}  // namespace arap::store
