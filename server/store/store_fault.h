// The faults of stores. Their sentences reach clients: no path, no address, no password in them.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/fault.h"
#include "server/store/session_record.h"

namespace arap::store {

// kStoreUnavailable; detail "why".
Fault Unavailable(std::string_view why);
// Because of errno, which is `number`.
Fault UnavailableErrno(int number);

// kDataLoss of a record; details "owner" and "session".
Fault LostRecord(const SessionKey& key);
// kDataLoss of a blob; details "blob" and "why": "missing" or "damaged".
Fault LostBlob(const std::string& hash, std::string_view why);

}  // namespace arap::store
