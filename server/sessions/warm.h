// Warming: what a session names, computed — found where it is kept, or built again from what is
// stored.
#pragma once

#include <cstddef>
#include <string>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "server/access/caller.h"
#include "server/engine.h"
#include "server/sessions/entries.h"
#include "server/sessions/session.h"

namespace arap::app {

DerivedKey MeshKey(const std::string& owner, const std::string& blob);
DerivedKey HandleSetKey(const store::SessionKey& session, const std::string& handle_set_id);

// Whether the next call does without building. Never blocks. True also for what does not exist: to
// say so is quick.
bool IsWarmMesh(Engine& engine, const Session& session, const std::string& mesh_id);
bool IsWarmHandleSet(Engine& engine, const Session& session, const std::string& handle_set_id);

// The entries. When they are not warm it takes as long as registration and compilation: for the job
// lane. Faults: kNotFound; kDataLoss for a blob that is missing or damaged; kLimitExceeded when the
// memory is not to be had; kStoreUnavailable; and what `cancel` answers.
Result<MeshEntry> WarmMesh(Engine& engine, const Caller& caller, const Session& session,
                           const std::string& mesh_id, const CancelToken& cancel);
Result<HandleSetEntry> WarmHandleSet(Engine& engine, const Caller& caller, const Session& session,
                                     const std::string& handle_set_id, const CancelToken& cancel);

// Keeps an entry that was just computed and stored. Returns the entry that is kept: the mesh of an
// equal one that came first. `blob` names the mesh that the set was compiled on.
MeshEntry KeepWarm(Engine& engine, const std::string& owner, MeshEntry entry);
HandleSetEntry KeepWarm(Engine& engine, const store::SessionKey& session, const std::string& blob,
                        HandleSetEntry entry);

}  // namespace arap::app
