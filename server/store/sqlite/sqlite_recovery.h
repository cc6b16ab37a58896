// How a damaged database of sessions is replaced by a new one with all that can be read.
#pragma once

#include <string>

#include "arap/base/result.h"
#include "server/store/recovery.h"

namespace arap::store {

inline constexpr const char* kDatabaseName = "/sessions.db";

// Builds a new sessions.db in `directory` from what can be read of the one there, which is kept as
// sessions.db.corrupt-N. Nobody may have it open. Interrupted at any point, nothing is lost: call
// FinishRecovery and begin again. kStoreUnavailable when a new one cannot be written.
Result<Recovery> RecoverDatabase(const std::string& directory);

// Ends what an interrupted RecoverDatabase began; harmless when there is nothing.
Status FinishRecovery(const std::string& directory);

}  // namespace arap::store
