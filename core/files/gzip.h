// What gzip has made smaller (.gz).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

bool IsGzip(std::string_view bytes);

// A few bytes may stand for a thousand times as many.
inline constexpr std::size_t kMostUnpacked = std::size_t{256} << 20U;

// The bytes as they were before, of one part or of several one after the other. `name` is what
// messages call the file. How many they are is found out before any of them is kept, so that what is
// refused takes no memory, and what is not takes its size.
//
// kInvalidOption for more than `most` bytes, and with the byte for damaged data (their check sum is
// looked at), a file that ends early or goes on with something else.
Result<std::string> Unpack(std::string_view bytes, const std::string& name,
                           std::size_t most = kMostUnpacked);

}  // namespace arap
