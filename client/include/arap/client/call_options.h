// What may be said about any call.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>

namespace arap::client {

struct CallOptions {
  // How long the whole call may take; the server gives up too. Without it a call waits for ever.
  std::optional<std::chrono::milliseconds> timeout = std::nullopt;
  // Asking its source to stop cancels a unary call, which then answers kCancelled. From any thread.
  std::stop_token stop = {};
};

}  // namespace arap::client
