#include "server/store/redis/redis.h"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <ctime>
#include <utility>

#include <fmt/format.h>
#include <pthread.h>

#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

using std::chrono::steady_clock;

constexpr std::string_view kScheme = "redis://";

bool ParseInt(std::string_view text, int low, int high, int& number) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return read.ec == std::errc{} && read.ptr == text.data() + text.size() && number >= low &&
         number <= high;
}

bool Unescape(std::string_view text, std::string& plain) {
  for (; !text.empty(); text.remove_prefix(1)) {
    if (text.front() != '%') {
      plain += text.front();
      continue;
    }
    unsigned byte = 0;
    if (text.size() < 3) return false;
    const auto read = std::from_chars(text.data() + 1, text.data() + 3, byte, 16);
    if (read.ec != std::errc{} || read.ptr != text.data() + 3) return false;
    plain += static_cast<char>(byte);
    text.remove_prefix(2);
  }
  return true;
}

// HOST, HOST:PORT, [v6] or [v6]:PORT.
bool ParsePlace(std::string_view place, RedisUrl& url) {
  std::string_view port;
  if (place.starts_with('[')) {
    const std::size_t end = place.find(']');
    if (end == std::string_view::npos) return false;
    url.host = place.substr(1, end - 1);
    port = place.substr(end + 1);
  } else {
    const std::size_t colon = place.find(':');
    url.host = place.substr(0, colon);
    port = colon == std::string_view::npos ? std::string_view() : place.substr(colon);
  }
  if (url.host.empty()) return false;
  if (port.empty()) return true;
  return port.front() == ':' && ParseInt(port.substr(1), 1, 65535, url.port);
}

bool Parse(std::string_view text, RedisUrl& url) {
  if (!text.starts_with(kScheme)) return false;
  text.remove_prefix(kScheme.size());
  if (const std::size_t at = text.rfind('@'); at != std::string_view::npos) {
    const std::string_view user = text.substr(0, at);
    if (!user.starts_with(':') || !Unescape(user.substr(1), url.password)) return false;
    text.remove_prefix(at + 1);
  }
  if (const std::size_t slash = text.find('/'); slash != std::string_view::npos) {
    const std::string_view database = text.substr(slash + 1);
    if (!database.empty() && !ParseInt(database, 0, 1'000'000, url.database)) return false;
    text = text.substr(0, slash);
  }
  return ParsePlace(text, url);
}

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

Result<RedisUrl> ParseRedisUrl(const std::string& url) {
  RedisUrl parsed;
  if (Parse(url, parsed)) return parsed;
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("{} is not of the form redis://[:PASSWORD@]HOST[:PORT][/DB].",
                                WithoutPassword(url)))
                  .Field("store"));
}

std::string WithoutPassword(const std::string& url) {
  const std::size_t at = url.rfind('@');
  if (at == std::string::npos) return url;
  const std::size_t start = url.starts_with(kScheme) ? kScheme.size() : 0;
  return url.substr(0, start) + ":***" + url.substr(at);
}

RedisScript::RedisScript(std::string the_text)
    : text(std::move(the_text)), sha1(Sha1Hex(text).value_or("")) {}

Fault FaultOf(const RedisReply& error) {
  const std::string text = error.Text();
  return Unavailable(fmt::format("Redis refuses with {}", text.substr(0, text.find(' '))));
}

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

Result<RedisReply> RedisPool::Run(const RedisCommand& command) {
  TRY(auto replies, Run(std::vector<RedisCommand>{command}));
  if (replies.front().IsError()) return Fail(FaultOf(replies.front()));
  return std::move(replies.front());
}

Result<RedisReply> RedisPool::Run(const RedisScript& script, const std::vector<std::string>& keys,
                                  const std::vector<std::string>& arguments) {
  RedisCommand command{"EVALSHA", script.sha1, std::to_string(keys.size())};
  command.insert(command.end(), keys.begin(), keys.end());
  command.insert(command.end(), arguments.begin(), arguments.end());
  TRY(auto replies, Run(std::vector<RedisCommand>{command}));
  if (!replies.front().IsError()) return std::move(replies.front());
  // Redis forgets scripts when it starts.
  if (!replies.front().Text().starts_with("NOSCRIPT")) return Fail(FaultOf(replies.front()));
  command[0] = "EVAL";
  command[1] = script.text;
  return Run(command);
}

}  // namespace arap::store
