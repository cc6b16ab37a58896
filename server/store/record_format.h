// Session records as text, the same in every store that writes them down.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "server/store/store.h"

namespace arap::store {

// JSON in one line, with the number of the format. Every number comes back bit for bit: a double
// is the shortest decimal that reads back as itself, or its bits in a string when it is not
// finite. Times are whole milliseconds since 1970. kInternal for a string that is not UTF-8.
Result<std::string> EncodeRecord(const SessionRecord& record);

// Reads what this and every earlier version wrote. kStoreUnavailable, naming the format, for what a
// later version wrote; kDataLoss for text that EncodeRecord did not write; details "owner" and
// "session" are left to the caller, who knows where the text came from.
Result<SessionRecord> DecodeRecord(std::string_view text);

}  // namespace arap::store
