#include "server/store/redis/redis_pool.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "server/store/store.h"

namespace arap::store {
namespace {

using std::chrono::steady_clock;
using Kind = RedisUrl::Kind;

RedisAccess SentinelAccess(const RedisOptions& options) {
  RedisAccess access;
  access.password = options.sentinel_password;
  access.tls = options.url.access.tls;
  return access;
}

// From "MOVED SLOT HOST:PORT"; a node that does not know its own host leaves it out.
std::optional<RedisPlace> PlaceOfMoved(const RedisReply& moved, const RedisPlace& asked) {
  const std::string text = moved.Text();
  std::string place = text.substr(text.rfind(' ') + 1);
  if (place.starts_with(':')) return ParsePlace("[" + asked.host + "]" + place, 0);
  return ParsePlace(place, 0);
}

// A server that was the master, or had the slot, and is it no longer.
bool SaysAnotherIs(const std::vector<RedisReply>& replies) {
  return std::any_of(replies.begin(), replies.end(), [](const RedisReply& reply) {
    return reply.IsError("MOVED") || reply.IsError("READONLY");
  });
}

}  // namespace

std::string PrefixOf(const RedisOptions& options) {
  return options.url.kind == Kind::kCluster ? "{" + options.prefix + "}" : options.prefix;
}

RedisMaster::RedisMaster(const RedisOptions& options)
    : url_(options.url),
      sentinel_access_(SentinelAccess(options)),
      key_(PrefixOf(options)),
      timeout_(options.timeout) {}

RedisMaster::Opened RedisMaster::Open(const RedisPlace& place) const {
  return RedisConnection::Open(place, url_.access, timeout_);
}

std::vector<RedisPlace> RedisMaster::Places() const {
  std::vector<RedisPlace> places = url_.places;
  const MutexLock lock(&mutex_);
  if (!asked_) return places;
  std::erase(places, *asked_);
  places.insert(places.begin(), *asked_);
  return places;
}

void RedisMaster::Remember(const RedisPlace& asked, const RedisPlace& master) {
  const MutexLock lock(&mutex_);
  asked_ = asked;
  master_ = master;
}

Result<RedisPlace> RedisMaster::Ask(const RedisPlace& sentinel) const {
  auto connection = RedisConnection::Open(sentinel, sentinel_access_, timeout_);
  if (!connection) return Fail(Unavailable("no sentinel of Redis can be reached"));
  TRY(const auto reply,
      (*connection)->Run(RedisCommand{"SENTINEL", "get-master-addr-by-name", url_.master}));
  const std::vector<std::string> parts = reply.Texts();
  if (parts.size() != 2) {
    return Fail(Unavailable("the sentinels of Redis know no master of that name"));
  }
  const auto place = ParsePlace("[" + parts[0] + "]:" + parts[1], 0);
  if (!place) return Fail(Unavailable("a sentinel of Redis did not answer what was asked"));
  return *place;
}

RedisMaster::Opened RedisMaster::ConnectNamed(const RedisPlace& sentinel) {
  TRY(const RedisPlace place, Ask(sentinel));
  TRY(auto connection, Open(place));
  // A master that was cut off and comes back believes for a moment that it still is one, and a
  // replica is named a moment before it has become one.
  TRY(const auto role, connection->Run(RedisCommand{"ROLE"}));
  const std::vector<std::string> words = role.Texts();
  if (words.empty() || words.front() != "master") {
    return Fail(Unavailable("Redis is about to have another master"));
  }
  Remember(sentinel, place);
  return connection;
}

RedisMaster::Opened RedisMaster::ConnectOwner(RedisPlace node) {
  // Each node knows at least better who has the slot.
  constexpr int kMostMoves = 5;
  const std::vector<RedisCommand> question{{"EXISTS", key_}};
  for (int move = 0; move < kMostMoves; ++move) {
    TRY(auto connection, Open(node));
    TRY(const auto replies, connection->Run(question));
    const RedisReply& reply = replies.front();
    // ASK: it has the slot, which is being moved.
    if (!reply.IsError() || reply.IsError("ASK")) {
      Remember(node, node);
      return connection;
    }
    const auto next = reply.IsError("MOVED") ? PlaceOfMoved(reply, node) : std::nullopt;
    if (!next) return Fail(FaultOf(reply));
    node = *next;
  }
  return Fail(Unavailable("the nodes of the Redis cluster do not agree"));
}

Result<std::unique_ptr<RedisConnection>> RedisMaster::Connect() {
  if (url_.kind == Kind::kServer) return Open(url_.places.front());
  const auto start = steady_clock::now();
  const std::vector<RedisPlace> places = Places();
  for (std::size_t i = 0;; ++i) {
    auto connection =
        url_.kind == Kind::kCluster ? ConnectOwner(places[i]) : ConnectNamed(places[i]);
    if (connection || i + 1 == places.size()) return connection;
    if (steady_clock::now() - start < timeout_) continue;
    // Somebody hangs. The next call begins with the next place.
    const MutexLock lock(&mutex_);
    asked_ = places[i + 1];
    return connection;
  }
}

bool RedisMaster::HasMoved() {
  std::optional<RedisPlace> known;
  {
    const MutexLock lock(&mutex_);
    known = master_;
  }
  if (url_.kind != Kind::kSentinels || !known) return false;
  for (const RedisPlace& sentinel : Places()) {
    if (const auto place = Ask(sentinel); place) return *place != *known;
  }
  return false;
}

RedisPool::Idle RedisPool::TakeIdle() {
  const MutexLock lock(&mutex_);
  if (idle_.empty()) return {nullptr, age_};
  Idle idle = std::move(idle_.back());
  idle_.pop_back();
  return idle;
}

void RedisPool::Keep(Idle idle) {
  const MutexLock lock(&mutex_);
  if (idle.age != age_) return;
  dead_until_ = {};
  if (idle_.size() < kMaxIdle) idle_.push_back(std::move(idle));
}

void RedisPool::Broke(bool timed_out) {
  std::vector<Idle> old;
  const MutexLock lock(&mutex_);
  old.swap(idle_);
  ++age_;
  if (timed_out) dead_until_ = steady_clock::now() + timeout_;
}

Status RedisPool::CheckAlive() {
  const MutexLock lock(&mutex_);
  if (steady_clock::now() >= dead_until_) return {};
  return Fail(Unavailable("Redis did not answer in time a moment ago"));
}

Result<RedisPool::Connection> RedisPool::Connect() {
  const auto start = steady_clock::now();
  auto connection = master_.Connect();
  // Only a timeout is worth remembering; a refused connection comes back at once the next time too.
  if (!connection) Broke(steady_clock::now() - start >= timeout_);
  return connection;
}

void RedisPool::Follow() {
  if (master_.HasMoved()) Broke(false);
}

Result<std::vector<RedisReply>> RedisPool::Run(const std::vector<RedisCommand>& commands) {
  CHECK_OK(CheckAlive());
  Idle idle = TakeIdle();
  if (idle.connection != nullptr) {
    auto replies = idle.connection->Run(commands);
    if (replies && !SaysAnotherIs(*replies)) {
      Keep(std::move(idle));
      return replies;
    }
    const bool timed_out = idle.connection->timed_out();
    Broke(timed_out);
    if (timed_out) return Fail(replies.error());
    idle.age = TakeIdle().age;
  }
  TRY(idle.connection, Connect());
  auto replies = idle.connection->Run(commands);
  if (replies) {
    Keep(std::move(idle));
  } else {
    Broke(idle.connection->timed_out());
  }
  return replies;
}

Result<RedisReply> RedisPool::Run(const RedisCommand& command) {
  TRY(auto replies, Run(std::vector<RedisCommand>{command}));
  if (replies.front().IsError()) return Fail(FaultOf(replies.front()));
  return std::move(replies.front());
}

// WAIT on the same connection counts the replicas that have all that was changed before it. It
// may take half of the time that a command has.
Result<std::vector<RedisReply>> RedisPool::Change(std::vector<RedisCommand> commands) {
  if (replicas_ > 0) {
    commands.push_back({"WAIT", std::to_string(replicas_), std::to_string(timeout_.count() / 2)});
  }
  TRY(auto replies, Run(commands));
  if (replicas_ == 0) return replies;
  const RedisReply confirmed = std::move(replies.back());
  replies.pop_back();
  const RedisReply& first = replies.front();
  const bool changed =
      !first.IsError() && (first.Int() != 0 || !first.Text().empty() || !first.Texts().empty());
  if (!changed) return replies;
  if (confirmed.IsError()) return Fail(FaultOf(confirmed));
  if (confirmed.Int() >= replicas_) return replies;
  // It may be a master that was replaced and has not heard of it: the next call looks again.
  Broke(false);
  return Fail(Unavailable(fmt::format("only {} of {} replicas of Redis have confirmed a change",
                                      confirmed.Int(), replicas_)));
}

Result<RedisReply> RedisPool::Run(const RedisScript& script, const std::vector<std::string>& keys,
                                  const std::vector<std::string>& arguments) {
  RedisCommand command{"EVALSHA", script.sha1, std::to_string(keys.size())};
  command.insert(command.end(), keys.begin(), keys.end());
  command.insert(command.end(), arguments.begin(), arguments.end());
  TRY(auto replies, Change({command}));
  // Redis forgets scripts when it starts.
  if (replies.front().IsError("NOSCRIPT")) {
    command[0] = "EVAL";
    command[1] = script.text;
    TRY(replies, Change({command}));
  }
  if (replies.front().IsError()) return Fail(FaultOf(replies.front()));
  return std::move(replies.front());
}

}  // namespace arap::store
