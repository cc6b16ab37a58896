// The entries of a token file, from JSON. See token_file.h for the format.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "server/access/token_file.h"

namespace arap::app {

// By id. kInvalidOption with the details "file", "entry" and a field such as "[3].owner".
Result<std::map<std::string, TokenFile::Entry, std::less<>>> ParseTokenEntries(
    std::string_view json, const std::string& file, const OwnerLimits& defaults);

}  // namespace arap::app
