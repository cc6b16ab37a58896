// The Lua scripts of the Redis store, and the keys that they work on.
#pragma once

#include <string>

#include "server/store/redis/redis.h"

namespace arap::store {

// Keys, under a prefix, which in a cluster stands in braces and so puts all of them into one slot:
// scripts work on keys of a session, of its owner and of all at once.
//   session:PLACE   hash: incarnation, revision, token (of the Put that wrote it), record
//                   (record_format.h), expires (counts; the one in the record is that of the last
//                   Put), blobs
//   ids:OWNER       sorted set of the owner's session ids, all with score 0
//   counts:OWNER    hash: session id → "MESHES HANDLE_SETS BYTES"
//   owners          sorted set of the owners that have sessions, all with score 0
//   expiry          sorted set of PLACEs by expiry
//   id              of this store
//   done:TOKEN      for half a minute: the Remove with this token has removed something
// PLACE is LENGTH:OWNER:ID with the length of the owner in bytes.

// A session that no replica has removed a day after its expiry is removed by Redis itself: no
// replica has run for that long. The day is counted by the clock of Redis and from now at the
// earliest, so that a wrong clock of a replica removes nothing that was just written.
inline const char* const kKeepFunction = R"lua(
local function keep(session, expires)
  local now = tonumber(redis.call('TIME')[1]) * 1000
  local at = math.max(tonumber(expires), now) + 86400000
  redis.call('PEXPIREAT', session, string.format('%.0f', at))
end
)lua";

inline const char* const kForgetFunction = R"lua(
local function forget(session, ids, counts, owners, expiry, id, owner, place)
  local there = redis.call('DEL', session)
  redis.call('ZREM', ids, id)
  redis.call('HDEL', counts, id)
  redis.call('ZREM', expiry, place)
  if redis.call('EXISTS', ids) == 0 then redis.call('ZREM', owners, owner) end
  return there
end
)lua";

// KEYS session ids counts owners expiry
// ARGV revision-before revision token record expires counts blobs id owner place incarnation
// 1 when it was put, also by an earlier run with this token; else 0.
inline const char* const kPutBody = R"lua(
local stored = redis.call('HMGET', KEYS[1], 'revision', 'token', 'incarnation')
if stored[1] == ARGV[2] and stored[2] == ARGV[3] then return 1 end
if (stored[1] or '0') ~= ARGV[1] then return 0 end
if stored[1] and (stored[3] or '') ~= ARGV[11] then return 0 end
redis.call('HSET', KEYS[1], 'incarnation', ARGV[11], 'revision', ARGV[2], 'token', ARGV[3],
           'record', ARGV[4], 'expires', ARGV[5], 'blobs', ARGV[7])
redis.call('ZADD', KEYS[2], 0, ARGV[8])
redis.call('HSET', KEYS[3], ARGV[8], ARGV[6])
redis.call('ZADD', KEYS[4], 0, ARGV[9])
redis.call('ZADD', KEYS[5], ARGV[5], ARGV[10])
keep(KEYS[1], ARGV[5])
return 1
)lua";

// KEYS session expiry; ARGV expires place incarnation
inline const char* const kExtendBody = R"lua(
local stored = redis.call('HMGET', KEYS[1], 'revision', 'incarnation')
if not stored[1] or (stored[2] or '') ~= ARGV[3] then return 0 end
redis.call('HSET', KEYS[1], 'expires', ARGV[1])
redis.call('ZADD', KEYS[2], ARGV[1], ARGV[2])
keep(KEYS[1], ARGV[1])
return 1
)lua";

// KEYS session ids counts owners expiry done
// ARGV id owner place expires; an empty expires is any
// 1 when there was one, which this run or an earlier one with this token has removed.
inline const char* const kRemoveBody = R"lua(
if ARGV[4] ~= '' and redis.call('HGET', KEYS[1], 'expires') ~= ARGV[4] then
  return redis.call('EXISTS', KEYS[6])
end
local there = forget(KEYS[1], KEYS[2], KEYS[3], KEYS[4], KEYS[5], ARGV[1], ARGV[2], ARGV[3])
if there == 0 then return redis.call('EXISTS', KEYS[6]) end
redis.call('SET', KEYS[6], '', 'PX', 30000)
return there
)lua";

// KEYS owners expiry; ARGV prefix now limit. What has expired by `now` and by the clock of Redis.
// Owner and id of each that was removed.
inline const char* const kRemoveExpiredBody = R"lua(
local prefix = ARGV[1]
local removed = {}
local time = redis.call('TIME')
local now = math.min(tonumber(ARGV[2]), time[1] * 1000 + math.floor(time[2] / 1000))
local places = redis.call('ZRANGEBYSCORE', KEYS[2], '-inf', string.format('%.0f', now),
                          'LIMIT', 0, ARGV[3])
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

// KEYS a key that is not there; ARGV prefix cursor. The next cursor, then one string of blobs for
// every session on the way. Looks at the keys of the sessions themselves and not at an index: a
// session that were missed would lose its blobs. The key makes a node of a cluster that is giving
// its slot away refuse, since it has a part of the sessions only.
inline const char* const kReferencedBody = R"lua(
local page = redis.call('SCAN', ARGV[2], 'MATCH', ARGV[1] .. 'session:*', 'COUNT', 500)
local found = {page[1]}
for _, session in ipairs(page[2]) do
  local blobs = redis.call('HGET', session, 'blobs')
  if blobs then table.insert(found, blobs) end
end
return found
)lua";

struct RedisScripts {
  RedisScript put{std::string(kKeepFunction) + kPutBody};
  RedisScript extend{std::string(kKeepFunction) + kExtendBody};
  RedisScript remove{std::string(kForgetFunction) + kRemoveBody};
  RedisScript remove_expired{std::string(kForgetFunction) + kRemoveExpiredBody};
  RedisScript referenced{kReferencedBody};
};

}  // namespace arap::store
