// Ledger: what a client was told is on the server, to be compared with what is there.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/system/fault/client.h"

namespace arap::fault {

struct SetEntry {
  std::string mesh_id;
  std::vector<std::string> handle_ids;
  std::uint64_t revision = 1;
  std::string answer;  // bytes of the shape for FixedTargets; empty: never asked
};

struct SessionEntry {
  std::map<std::string, std::string> meshes;  // content hash by id; empty: not told
  std::map<std::string, SetEntry> sets;
};

// Nothing: no such session.
using MaybeSession = std::optional<SessionEntry>;

// What differs between an entry and what the server has: meshes, hashes, sets, handles, revisions.
// Empty when they agree. Answers are not looked at, nor hashes that are not known.
std::string Difference(const MaybeSession& expected, const MaybeSession& found);

// Asks for everything of a session. A failure of the test when an answer is neither OK nor
// NOT_FOUND, or a part that the session lists cannot be had.
MaybeSession ReadSession(FaultClient& client, const std::string& session_id);

// The ids of all sessions.
std::vector<std::string> ReadSessionIds(FaultClient& client);

// The same target for the same handle, always.
std::vector<v1::HandleTarget> FixedTargets(const std::vector<std::string>& handle_ids);

// The bytes of the double-precision shape for FixedTargets.
std::string BytesOf(const v1::Shape& shape);

}  // namespace arap::fault
