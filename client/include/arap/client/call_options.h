// What may be said about any call.
#pragma once

#include <chrono>
#include <optional>

namespace arap::client {

struct CallOptions {
  // How long the whole call may take; the server gives up too. Without it a call waits for ever.
  std::optional<std::chrono::milliseconds> timeout = std::nullopt;
};

}  // namespace arap::client
