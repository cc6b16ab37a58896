// DeformStream: live deformation. Updates go out, shapes come back, in the order of the updates.
//
// Threads: one thread may Read while others send; senders are put in a row. Cancel may be called
// from any thread. Everything else is for one thread at a time. Move-only; the destructor cancels a
// stream that was not read to its end, so stop other threads first.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "arap/client/error.h"
#include "arap/client/handles.h"
#include "arap/client/shape.h"

namespace arap::client {

// Which updates are answered.
enum class Delivery {
  kLatest,  // a new update replaces one that has not started; for interaction
  kEvery,   // every update is answered; for baking
};

// Moves handles. Give either targets or positions.
struct HandleUpdate {
  std::uint64_t sequence = 0;         // grows from message to message; answers repeat it
  std::vector<HandleTarget> targets;  // any subset of the handles; the others stay where they are
  std::vector<double> positions;      // all handles in the order of the set: x y x y…
  std::vector<double> pick_points;  // deformed points x y x y… to map back to rest, at most 1024
};

// A bad update or edit. The stream goes on.
struct UpdateError {
  std::uint64_t sequence = 0;
  Fault fault;
};

// The answer to a ping.
struct Pong {
  std::uint64_t nonce = 0;
};

using StreamEvent = std::variant<Shape, UpdateError, Pong>;

class DeformStream {
 public:
  DeformStream(DeformStream&&) noexcept;
  DeformStream& operator=(DeformStream&&) noexcept;
  ~DeformStream();

  // The handle set as it was when the stream opened.
  const HandleSetInfo& handle_set() const;

  // Each waits until the message is handed to the transport, which is HTTP/2's back-pressure.
  // kProtocol: the stream is over; Read says why.
  Status Send(const HandleUpdate& update);
  // Changes the handle set; removals come first. The answer is a shape with the new revision.
  Status Edit(std::uint64_t sequence, std::span<const std::string> remove,
              std::span<const Handle> add);
  // Asks for a sign of life.
  Status Ping(std::uint64_t nonce);
  // Says that nothing more will be sent. The server answers what is pending and ends the stream.
  Status CloseSending();

  // Waits for the next event. Empty: the stream ended well. A fault: it is broken; reads after
  // either repeat it.
  Result<std::optional<StreamEvent>> Read();

  // Ends the stream at once; a waiting Read answers kCancelled.
  void Cancel();

 private:
  friend class Session;
  class Impl;
  explicit DeformStream(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace arap::client
