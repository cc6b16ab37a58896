// SessionRecord: what a session is — everything heavy can be rebuilt from it and its blobs.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "arap/model/handle.h"
#include "server/runtime/clock.h"

namespace arap::store {

// Owners do not see each other: the same id of two owners names two sessions.
struct SessionKey {
  std::string owner;
  std::string id;

  // clang-tidy takes the zero in the generated comparison for a pointer.
  auto operator<=>(const SessionKey&) const = default;  // NOLINT(modernize-use-nullptr)
};

// A mesh with its options. `blob` is the SHA-256 of the mesh blob (mesh_blob.h) and at the same
// time the content hash.
struct MeshRecord {
  std::string blob;
};

struct HandleSetRecord {
  std::string mesh_id;
  std::vector<Handle> definitions;  // as the client gave them, after the edits so far
  std::uint64_t revision = 1;       // grows by one with every edit
};

struct SessionRecord {
  SessionKey key;
  std::chrono::milliseconds ttl{};
  std::map<std::string, std::string> labels;
  runtime::Clock::Wall created;              // whole milliseconds
  runtime::Clock::Wall expires;              // likewise; no earlier than what the client was told
  std::map<std::string, MeshRecord> meshes;  // by mesh id
  std::map<std::string, HandleSetRecord> handle_sets;  // by handle set id
  std::uint64_t revision = 1;  // grows by one with every change but that of `expires`
};

}  // namespace arap::store
