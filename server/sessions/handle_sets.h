// Handle sets: compiled and edited in a session, found there again, or compiled again after they were
// evicted.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"
#include "arap/core/cost.h"
#include "arap/model/handle.h"
#include "server/access/caller.h"
#include "server/budget/derived_cache.h"
#include "server/sessions/meshes.h"
#include "server/sessions/session.h"
#include "server/sessions/workshop.h"

namespace arap::app {

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

// Takes one back-substitution per constraint row: for the job lane. Stored before it answers.
// Compiling the same handles under the same id again is harmless. Faults: kInvalidName, kNotFound,
// kTooManyHandles, kAlreadyExists, kLimitExceeded, those of CompiledHandles::Compile and of the
// store.
Result<HandleSetEntry> CompileHandles(Workshop& workshop, const Caller& caller,
                                      const std::string& session_id, const std::string& mesh_id,
                                      const std::string& handle_set_id,
                                      const std::vector<Handle>& handles,
                                      const CancelToken& cancel);

// The entry. A warm one costs two look-ups, whatever its size; else this takes as long as
// compilation, and registration when the mesh is not warm either: for the job lane. Faults: those of
// WarmMesh.
Result<HandleSetEntry> WarmHandleSet(Workshop& workshop, const Caller& caller,
                                     const Session& session, const std::string& handle_set_id,
                                     const CancelToken& cancel);

// Removes, then adds, and stores the next revision. Edits of one set that meet are done one after
// the other. Faults: kNotFound, kUnknownHandle, kTooManyHandles and those of Compile with fields
// "add[i]…".
Result<HandleSetEntry> EditHandles(Workshop& workshop, const Caller& caller,
                                   const std::string& session_id, const std::string& handle_set_id,
                                   const std::vector<std::string>& remove,
                                   const std::vector<Handle>& add, const CancelToken& cancel);

// What EditEntry will take. What CompiledHandles::Edit will refuse costs nothing: it says why itself.
// Faults: kTooManyHandles, and what `cancel` answers.
Result<Cost> EditCostOf(const HandleSetEntry& entry, const std::vector<std::string>& remove,
                        const std::vector<Handle>& add, const Limits& limits,
                        const CancelToken& cancel);

// One edit on its own: the next revision of `entry`, not stored anywhere.
Result<HandleSetEntry> EditEntry(const HandleSetEntry& entry,
                                 const std::vector<std::string>& remove,
                                 const std::vector<Handle>& add, const Limits& limits,
                                 const CancelToken& cancel);

// kNotFound.
Status DeleteHandleSet(Workshop& workshop, const Caller& caller, const std::string& session_id,
                       const std::string& handle_set_id);

struct PeekedSet {
  Warmth warmth = Warmth::kMissing;
  std::shared_ptr<const CompiledHandles> handles;  // kWarm
};
// Never blocks and counts no look-up.
PeekedSet PeekHandleSet(Workshop& workshop, const Session& session,
                        const std::string& handle_set_id);

// Under this key the cache keeps a set.
DerivedKey HandleSetKey(const store::SessionKey& session, const std::string& handle_set_id);

}  // namespace arap::app
