// Workshop: what the use cases on sessions share — where sessions are kept, and what they name,
// computed: found in the cache, or built again from what is stored after it was evicted, after a
// restart or on another replica.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"
#include "arap/core/cost.h"
#include "arap/core/registered_mesh.h"
#include "arap/model/limits.h"
#include "server/access/caller.h"
#include "server/budget/derived_cache.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"
#include "server/sessions/session.h"
#include "server/sessions/session_registry.h"
#include "server/store/open_store.h"
#include "server/store/store_keeper.h"

namespace arap::app {

// Under these keys the cache keeps what a session names.
DerivedKey MeshKey(const std::string& owner, const std::string& blob);
DerivedKey HandleSetKey(const store::SessionKey& session, const std::string& handle_set_id);

// Thread-safe member by member.
struct Workshop {
  // `the_clock` outlives the workshop.
  Workshop(const Limits& the_limits, const runtime::Clock& the_clock, store::Stores the_stores);
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  // Forgets what was computed for a session, or for a handle set or a mesh of it, that is no more.
  void Release(const store::SessionRecord& record);
  void ReleaseHandleSet(const store::SessionKey& session, const std::string& handle_set_id);
  void ReleaseMesh(const std::string& owner, const std::string& blob);

  runtime::Metrics metrics;  // first: the others count in it until their end
  const Limits limits;
  const runtime::Clock& clock;
  const store::Stores stores;
  store::StoreKeeper keeper;
  DerivedCache derived;
  SessionRegistry sessions;
};

// A mesh under the id that the client gave it.
struct MeshEntry {
  std::string mesh_id;
  std::string content_hash;  // also the name of its blob
  std::shared_ptr<const RegisteredMesh> mesh;
};

// A handle set under the id that the client gave it.
struct HandleSetEntry {
  std::string handle_set_id;
  std::string mesh_id;
  // As the client gave them, after the edits so far; shared with the session's record.
  store::HandleDefinitions definitions;
  std::shared_ptr<const CompiledHandles> handles;
  std::uint64_t revision = 1;  // grows by one with every edit
  std::string blob = {};       // of the mesh that they were compiled on
};

// Warm is what the next call finds in the cache. These never block and count no look-up.
enum class Warmth {
  kMissing,  // there is no such thing: to say so is quick
  kCold,     // it has to be computed again
  kWarm,
};
struct PeekedMesh {
  Warmth warmth = Warmth::kMissing;
  std::shared_ptr<const RegisteredMesh> mesh;  // kWarm
};
struct PeekedSet {
  Warmth warmth = Warmth::kMissing;
  std::shared_ptr<const CompiledHandles> handles;  // kWarm
};
PeekedMesh PeekMesh(Workshop& workshop, const Session& session, const std::string& mesh_id);
PeekedSet PeekHandleSet(Workshop& workshop, const Session& session,
                        const std::string& handle_set_id);

// The entries. When they are not warm this takes as long as registration and compilation: for the
// job lane. A warm handle set costs two look-ups, whatever its size. Faults: kNotFound; kDataLoss
// for a blob that is missing or damaged; kLimitExceeded when the memory is not to be had;
// kStoreUnavailable; and what `cancel` answers.
Result<MeshEntry> WarmMesh(Workshop& workshop, const Caller& caller, const Session& session,
                           const std::string& mesh_id, const CancelToken& cancel);
Result<HandleSetEntry> WarmHandleSet(Workshop& workshop, const Caller& caller,
                                     const Session& session, const std::string& handle_set_id,
                                     const CancelToken& cancel);

// What CompiledHandles::Compile will take. Handles that it will refuse cost nothing: it says why
// itself. Faults: what `cancel` answers.
Result<Cost> CompilationCostOf(const RegisteredMesh& mesh, const std::vector<Handle>& handles,
                               const CancelToken& cancel);
// The same when CountRows has answered `fault`.
Result<Cost> CostOfRefused(Fault fault);

// Keeps an entry that was just computed and stored. Returns the entry that is kept: the mesh of an
// equal one that came first. `blob` names the mesh that the set was compiled on.
MeshEntry KeepWarm(Workshop& workshop, const std::string& owner, MeshEntry entry);
HandleSetEntry KeepWarm(Workshop& workshop, const store::SessionKey& session,
                        const std::string& blob, HandleSetEntry entry);

}  // namespace arap::app
