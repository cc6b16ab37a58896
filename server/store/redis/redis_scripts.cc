#include "server/store/redis/redis_scripts.h"

#include <array>
#include <span>
#include <string_view>
#include <utility>

#include <openssl/evp.h>

#include "core/base/hex.h"

namespace arap::store {
namespace {

// A session that no replica has removed a day after its expiry is removed by Redis itself: no
// replica has run for that long. The day is counted by the clock of Redis and from now at the
// earliest, so that a wrong clock of a replica removes nothing that was just written.
constexpr std::string_view kKeep = R"lua(
local function keep(session, expires)
  local now = tonumber(redis.call('TIME')[1]) * 1000
  local at = math.max(tonumber(expires), now) + 86400000
  redis.call('PEXPIREAT', session, string.format('%.0f', at))
end
)lua";

constexpr std::string_view kForget = R"lua(
local function forget(session, ids, counts, owners, expiry, id, owner, place)
  local there = redis.call('DEL', session)
  redis.call('ZREM', ids, id)
  redis.call('HDEL', counts, id)
  redis.call('ZREM', expiry, place)
  if redis.call('EXISTS', ids) == 0 then redis.call('ZREM', owners, owner) end
  return there
end
)lua";

constexpr std::string_view kPut = R"lua(
local stored = redis.call('HMGET', KEYS[1], 'revision', 'token')
if stored[1] == ARGV[2] and stored[2] == ARGV[3] then return 1 end
if (stored[1] or '0') ~= ARGV[1] then return 0 end
redis.call('HSET', KEYS[1], 'revision', ARGV[2], 'token', ARGV[3], 'record', ARGV[4],
           'expires', ARGV[5], 'blobs', ARGV[7])
redis.call('ZADD', KEYS[2], 0, ARGV[8])
redis.call('HSET', KEYS[3], ARGV[8], ARGV[6])
redis.call('ZADD', KEYS[4], 0, ARGV[9])
redis.call('ZADD', KEYS[5], ARGV[5], ARGV[10])
keep(KEYS[1], ARGV[5])
return 1
)lua";

constexpr std::string_view kExtend = R"lua(
if redis.call('EXISTS', KEYS[1]) == 0 then return 0 end
redis.call('HSET', KEYS[1], 'expires', ARGV[1])
redis.call('ZADD', KEYS[2], ARGV[1], ARGV[2])
keep(KEYS[1], ARGV[1])
return 1
)lua";

constexpr std::string_view kRemove = R"lua(
return forget(KEYS[1], KEYS[2], KEYS[3], KEYS[4], KEYS[5], ARGV[1], ARGV[2], ARGV[3])
)lua";

constexpr std::string_view kRemoveExpired = R"lua(
local prefix = ARGV[1]
local removed = {}
local places = redis.call('ZRANGEBYSCORE', KEYS[2], '-inf', ARGV[2], 'LIMIT', 0, ARGV[3])
for _, place in ipairs(places) do
  local size, rest = string.match(place, '^(%d+):(.*)$')
  local owner = string.sub(rest, 1, tonumber(size))
  local id = string.sub(rest, tonumber(size) + 2)
  forget(prefix .. 'session:' .. place, prefix .. 'ids:' .. owner, prefix .. 'counts:' .. owner,
         KEYS[1], KEYS[2], id, owner, place)
  table.insert(removed, owner)
  table.insert(removed, id)
end
return removed
)lua";

// Looks at the keys of the sessions themselves and not at an index: a session that were missed
// would lose its blobs.
constexpr std::string_view kReferenced = R"lua(
local page = redis.call('SCAN', ARGV[2], 'MATCH', ARGV[1] .. 'session:*', 'COUNT', 500)
local found = {page[1]}
for _, session in ipairs(page[2]) do
  local blobs = redis.call('HGET', session, 'blobs')
  if blobs then table.insert(found, blobs) end
end
return found
)lua";

std::string Sha1(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha1(), nullptr) != 1) {
    return {};
  }
  return Hex(std::span(digest).first(size));
}

RedisScript Make(std::string_view functions, std::string_view body) {
  std::string text(functions);
  text += body;
  std::string sha1 = Sha1(text);
  return {std::move(text), std::move(sha1)};
}

}  // namespace

// Scripts are never destroyed: the stores that use them may end late.
const RedisScript& PutScript() {
  static const RedisScript& script = *new RedisScript(Make(kKeep, kPut));
  return script;
}

const RedisScript& ExtendScript() {
  static const RedisScript& script = *new RedisScript(Make(kKeep, kExtend));
  return script;
}

const RedisScript& RemoveScript() {
  static const RedisScript& script = *new RedisScript(Make(kForget, kRemove));
  return script;
}

const RedisScript& RemoveExpiredScript() {
  static const RedisScript& script = *new RedisScript(Make(kForget, kRemoveExpired));
  return script;
}

const RedisScript& ReferencedScript() {
  static const RedisScript& script = *new RedisScript(Make("", kReferenced));
  return script;
}

}  // namespace arap::store
