// The Lua scripts of the Redis store. Redis runs each as one step; no other command comes between.
#pragma once

#include <string>

namespace arap::store {

struct RedisScript {
  std::string text;
  std::string sha1;  // by which Redis knows it; empty if it could not be computed
};

// Keys, under a prefix:
//   session:PLACE   hash: revision, token (of the Put that wrote it), record (record_format.h),
//                   expires (counts; the one in the record is that of the last Put), blobs
//   ids:OWNER       sorted set of the owner's session ids, all with score 0
//   counts:OWNER    hash: session id → "MESHES HANDLE_SETS"
//   owners          sorted set of the owners that have sessions, all with score 0
//   expiry          sorted set of PLACEs by expiry
// PLACE is LENGTH:OWNER:ID with the length of the owner in bytes.

// KEYS session ids counts owners expiry
// ARGV revision-before revision token record expires counts blobs id owner place
// 1 when it was put, also by an earlier run with this token; else 0.
const RedisScript& PutScript();
// KEYS session expiry; ARGV expires place
const RedisScript& ExtendScript();
// KEYS session ids counts owners expiry; ARGV id owner place. 1 when there was one.
const RedisScript& RemoveScript();
// KEYS owners expiry; ARGV prefix now limit. Owner and id of each that was removed.
const RedisScript& RemoveExpiredScript();
// ARGV prefix cursor. The next cursor, then one string of blobs for every session on the way.
const RedisScript& ReferencedScript();

}  // namespace arap::store
