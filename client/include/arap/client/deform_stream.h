// DeformStream: live deformation. Updates go out, shapes come back, in the order of the updates.
//
// A stream that is asked to resume (StreamOptions::resume_within) survives its server: Read opens
// it again, on whichever server answers, says again what the new one has to know (targets, the
// stream's own edits, whatever has no answer yet), and answers Resumed. The shapes that follow are
// those of an uninterrupted stream, and no answer comes twice. Somebody has to Read for that.
// Meanwhile sends to a kLatest stream are kept, newer ones in the place of older ones, and sends to
// a kEvery stream wait. Memory: a target per handle and edit, and what has no answer yet; of the
// updates to a kLatest stream, which newer ones replace, a few hundred.
//
// Threads: one thread may Read while others send; senders are put in a row. Cancel may be called
// from any thread. Everything else is for one thread at a time. Move-only; the destructor cancels a
// stream that was not read to its end, so stop other threads first.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "arap/client/call.h"
#include "arap/client/handles.h"
#include "arap/client/shape.h"

namespace arap::client {

// Which updates are answered.
enum class Delivery {
  kLatest,  // a new update replaces one that has not started; for interaction
  kEvery,   // every update is answered; for baking
};

struct StreamOptions {
  Delivery delivery = Delivery::kLatest;
  ShapeOptions shape = {};

  // After this much silence the server is asked for a sign of life; 0: never. The stream then
  // counts as used also when nobody moves a handle, and a server that is gone is noticed also
  // behind a proxy that answers for it.
  std::chrono::milliseconds heartbeat = std::chrono::seconds(5);
  // A Read, or an opening, that hears nothing for so long counts the server as gone. Longer than
  // the longest frame: a server that works on one may answer late, and after CloseSending it cannot
  // be asked. Ignored when heartbeat is 0.
  std::chrono::milliseconds silence = std::chrono::seconds(30);

  // For how long an opening, an update, an edit or the end may be without answer while somebody
  // reads, and a message without being taken while somebody sends it, whatever signs of life there
  // are. The stream then ends with kDeadlineExceeded. Longer than the longest frame and the longest
  // edit.
  std::chrono::milliseconds answer = kWorkLimit;

  // For how long a stream that was lost is opened again and again, growing pauses of up to 2 s
  // apart, until the server has caught up; 0: not at all. An attempt under way is not cut short; it
  // ends with an answer or after `silence`. Lost is what ended with the server gone or going away:
  // silence, UNAVAILABLE, and what proxies make of it: UNKNOWN "No status received" or "Stream
  // removed", INTERNAL "RST_STREAM", CANCELLED. After silence the next attempt is made over a new
  // connection. A server that has no room (RESOURCE_EXHAUSTED) is asked again too. Anything else is
  // final.
  std::chrono::milliseconds resume_within{0};
};

// Moves handles. Give either targets or positions.
struct HandleUpdate {
  std::uint64_t sequence = 0;         // grows with every update and edit; answers repeat it
  std::vector<HandleTarget> targets;  // any subset of the handles; the others stay where they are
  std::vector<Complex> positions;     // all handles in the order of the set; angles and scales stay
  std::vector<Complex> pick_points;   // deformed points to map back to rest, at most 1024
  // Measure the shape whatever measure_every says, or the one that answers a newer update in its
  // place. Where a hand rests, an update without targets asks for the quality of what stays.
  bool measure = false;
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

// The stream was lost and goes on, perhaps on another server.
struct Resumed {
  // As the session holds it now, without the stream's own edits; with another revision than before
  // when somebody has edited it.
  HandleSetInfo handle_set;
  std::uint32_t attempts = 0;  // to open it again
};

using StreamEvent = std::variant<Shape, UpdateError, Pong, Resumed>;

class DeformStream {
 public:
  DeformStream(DeformStream&&) noexcept;
  DeformStream& operator=(DeformStream&&) noexcept;
  ~DeformStream();

  // The handle set as it was when the stream opened.
  const HandleSetInfo& handle_set() const;

  // Each waits until the message is handed to the transport, which is HTTP/2's back-pressure.
  // kProtocol: the stream is over; Read says why. kInvalidOption, when it resumes: the sequence has
  // not grown.
  Status Send(const HandleUpdate& update);
  // Changes the handle set; removals come first. The answer is a shape with the new revision, which
  // is always measured.
  Status Edit(std::uint64_t sequence, std::span<const std::string> remove,
              std::span<const Handle> add);
  // Asks for a sign of life.
  Status Ping(std::uint64_t nonce);
  // Says that nothing more will be sent. The server answers what is pending and ends the stream.
  Status CloseSending();

  // Waits for the next event. Empty: the stream ended well. A fault: it is broken, the server sent
  // what was not asked for (kInternal), or it could not be resumed in time; reads after either
  // repeat it. A shape answers an update or edit that was sent, in their order, with as many
  // vertices as were asked for or else as the mesh has (or as the first shape, of a mesh that the
  // session has never seen).
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
