#include "tests/server/store/redis_server.h"

#include <utility>

#include <hiredis/hiredis.h>

namespace arap::testing {
namespace {

bool Answers(int port) {
  const timeval limit{1, 0};
  redisContext* context = redisConnectWithTimeout("127.0.0.1", port, limit);
  bool good = false;
  if (context != nullptr && context->err == 0) {
    redisSetTimeout(context, limit);
    // Redis that wants a password or still loads answers with an error: only NOAUTH is ready.
    auto* reply = static_cast<redisReply*>(redisCommand(context, "PING"));
    good = reply != nullptr && (reply->type != REDIS_REPLY_ERROR ||
                                std::string(reply->str, reply->len).starts_with("NOAUTH"));
    if (reply != nullptr) freeReplyObject(reply);
  }
  if (context != nullptr) redisFree(context);
  return good;
}

}  // namespace

RedisServer::RedisServer(RedisSetup setup)
    : setup_(std::move(setup)), server_([this](int port) { return CommandLine(port); }, Answers) {}

std::string RedisServer::Url() const {
  const std::string user = setup_.password.empty() ? "" : ":" + setup_.password + "@";
  return "redis://" + user + "127.0.0.1:" + std::to_string(port());
}

std::vector<std::string> RedisServer::CommandLine(int port) const {
  if (!setup_.sentinel.empty()) {
    // It writes into the file what it has found out.
    const std::string file = dir_ / "sentinel.conf";
    Spill(file, "port " + std::to_string(port) + "\nbind 127.0.0.1\ndir " + dir_.path() +
                    "\nlogfile " + (dir_ / "log") + "\n" + setup_.sentinel);
    return {ARAP_REDIS_SERVER, file, "--sentinel"};
  }
  std::vector<std::string> words{ARAP_REDIS_SERVER,
                                 "--bind",
                                 "127.0.0.1",
                                 "--port",
                                 std::to_string(port),
                                 "--dir",
                                 dir_.path(),
                                 "--appendonly",
                                 "yes",
                                 "--appendfsync",
                                 "always",
                                 "--save",
                                 "",
                                 "--logfile",
                                 dir_ / "log",
                                 "--daemonize",
                                 "no"};
  if (!setup_.password.empty()) words.insert(words.end(), {"--requirepass", setup_.password});
  words.insert(words.end(), setup_.words.begin(), setup_.words.end());
  return words;
}

}  // namespace arap::testing
