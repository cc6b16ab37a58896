// Impatience: ends a call whose next message does not come.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

namespace grpc {
class ClientContext;
}

namespace arap::client::internal {

// Has a thread of its own for as long as it lives. `context` outlives it, and its call begins after
// it.
class Impatience {
 public:
  // Cancels the call when nothing has come for `limit` while it was waited for.
  Impatience(grpc::ClientContext& context, std::chrono::milliseconds limit);

  // What `read` answers, which waits for a message or the end.
  template <class Read>
  bool Wait(const Read& read) {
    SetWaiting(true);
    const bool got = read();
    SetWaiting(false);
    return got;
  }
  // Whether it has cancelled the call. From any thread.
  bool is_lost() const;

 private:
  void SetWaiting(bool waiting);

  const std::chrono::milliseconds limit_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::uint64_t changes_ = 0;
  bool waiting_ = false;
  bool lost_ = false;
  std::jthread watch_;  // last: it uses all of the above
};

}  // namespace arap::client::internal
