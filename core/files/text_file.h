// Whole files, read and written at once.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

// kNotFound with the path and the system's reason.
Result<std::string> ReadTextFile(const std::string& path);
// kInternal with the path and the system's reason.
Status WriteTextFile(const std::string& path, std::string_view text);

}  // namespace arap
