// Handle sets: compiled and edited in a session.
#pragma once

#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/handle.h"
#include "server/access/caller.h"
#include "server/sessions/workshop.h"

namespace arap::app {

// Takes one back-substitution per constraint row: for the job lane. Stored before it answers.
// Compiling the same handles under the same id again is harmless. Faults: kInvalidName, kNotFound,
// kTooManyHandles, kAlreadyExists, kLimitExceeded, those of CompiledHandles::Compile and of the
// store.
Result<HandleSetEntry> CompileHandles(Workshop& workshop, const Caller& caller,
                                      const std::string& session_id, const std::string& mesh_id,
                                      const std::string& handle_set_id,
                                      const std::vector<Handle>& handles,
                                      const CancelToken& cancel);

// Removes, then adds, and stores the next revision. Edits of one set that meet are done one after
// the other. Faults: kNotFound, kUnknownHandle, kTooManyHandles and those of Compile with fields
// "add[i]…".
Result<HandleSetEntry> EditHandles(Workshop& workshop, const Caller& caller,
                                   const std::string& session_id, const std::string& handle_set_id,
                                   const std::vector<std::string>& remove,
                                   const std::vector<Handle>& add, const CancelToken& cancel);

// What EditEntry will take, as CompilationCostOf. kTooManyHandles.
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

}  // namespace arap::app
