#include "client/src/impatience.h"

#include <grpcpp/client_context.h>

namespace arap::client::internal {

Impatience::Impatience(grpc::ClientContext& context, std::chrono::milliseconds limit)
    : limit_(limit), watch_([this, &context](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
          const std::uint64_t seen = changes_;
          const auto changed = [&] { return changes_ != seen; };
          if (!waiting_) {
            changed_.wait(lock, stop, changed);
          } else if (!changed_.wait_for(lock, stop, limit_, changed) && !stop.stop_requested()) {
            lost_ = true;
            context.TryCancel();
            return;
          }
        }
      }) {}

void Impatience::SetWaiting(bool waiting) {
  const std::lock_guard lock(mutex_);
  waiting_ = waiting;
  ++changes_;
  changed_.notify_all();
}

bool Impatience::is_lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

}  // namespace arap::client::internal
