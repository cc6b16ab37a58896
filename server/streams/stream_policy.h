// StreamPolicy: the rules of one live stream, without the wire.
//
// It is told what has happened (a message was read, a job or a write has ended, time has passed)
// and says what to do next. Whoever drives it reads, writes and runs jobs; it keeps these rules:
//   - The first message opens, exactly once. What breaks this, or is empty or too large, ends the
//     stream.
//   - A message that was read is held until it can be taken; nothing is read meanwhile, nor while a
//     pong waits to be written.
//   - LATEST takes an update at once, in the place of one that has not started; the next shape
//     counts those replaced. EVERY takes an update when the one before it has started, so that
//     every one is answered.
//   - One job at a time. An update starts when no answer waits for the write before it; with LATEST
//     also when the shape that waits may be replaced.
//   - Answers keep the order of the messages: an edit, and a message that is refused, is taken when
//     everything before it is answered. Pongs go before all answers.
//   - An update moves the handles that it names; the others keep their last target, at first where
//     they rest. A refused one moves nothing. Targets given as positions leave the angles and
//     scales of oriented handles as they are.
//   - An edit changes the set of this stream only; nothing else is taken until it is done.
//   - At most max_stream_fps updates a second are taken after a burst of as many, and a stream is
//     admitted with its first update and whenever it wakes up (admission.h). What is too much waits
//     as long as answers are under way, and is refused when there are none.
//   - What is expected to take long is a job.
//   - Of the shapes of updates the first is measured, and every n-th after one that was, as the
//     stream was opened; besides, whatever takes the place of an update that asks for it, or of a
//     measured shape that waits. When a measured one fails the next is measured.
//   - Updates and edits extend the life of the session; when that is over, the stream ends.
//   - Nothing read for max_stream_idle ends the stream.
//   - Once it ends nothing is taken or started. The job in work is waited for and what was computed
//     is still written, except to a client that has gone or has not read for kLastWrite.
//   - After the client's half-close what is pending is answered and the end is OK.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "arap/base/fault.h"
#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"
#include "arap/model/limits.h"
#include "server/runtime/clock.h"
#include "server/runtime/token_bucket.h"
#include "server/streams/admission.h"
#include "server/streams/targets.h"

namespace arap::app {

// An answer as the wire has it, made by a job and written by the reactor. What is between them
// passes it on unread.
struct WireAnswer {
  WireAnswer() = default;
  WireAnswer(const WireAnswer&) = delete;
  WireAnswer& operator=(const WireAnswer&) = delete;
  virtual ~WireAnswer() = default;
};

struct StreamAnswer {
  enum class Kind { kOpened, kShape, kError, kPong };
  Kind kind = Kind::kOpened;
  std::uint64_t sequence = 0;           // kShape, kError: of the message that it answers
  std::uint64_t replaced = 0;           // kShape: updates that newer ones replaced
  bool measured = true;                 // kShape
  std::unique_ptr<WireAnswer> message;  // kOpened, kShape
  std::optional<Fault> fault;           // kError
  std::uint64_t nonce = 0;              // kPong
};

// StreamOutbox: the answers of one stream that wait for the write before them.
// Not thread-safe. Bounded by its user: work starts only when there is room, and reading pauses
// while a pong waits, so that a client that does not read costs one waiting answer and one waiting
// pong.
class StreamOutbox {
 public:
  // No answer waits. (A pong may.)
  bool empty() const { return answers_.empty(); }
  bool pong_waits() const { return pong_.has_value(); }
  // Whether the only answer that waits is the shape of an update, which a newer one may replace.
  bool replaceable() const { return answers_.size() == 1 && answers_.front().replaceable; }
  bool replaces_measured() const { return replaceable() && answers_.front().answer.measured; }

  // Adds an answer behind the others.
  void Push(StreamAnswer answer) { answers_.push_back({std::move(answer), false}); }

  // Adds the shape of an update. With `latest` it takes the place of a replaceable one and counts
  // it, and what that one had replaced, in its own `replaced`.
  void PushUpdate(StreamAnswer shape, bool latest) {
    if (latest && replaceable()) {
      shape.replaced += answers_.front().answer.replaced + 1;
      answers_.clear();
    }
    answers_.push_back({std::move(shape), true});
  }

  void SetPong(std::uint64_t nonce) { pong_ = nonce; }

  // The next message, a pong before the answers. Nothing when there is none.
  std::optional<StreamAnswer> Pop() {
    std::optional<StreamAnswer> next;
    if (pong_) {
      next.emplace().kind = StreamAnswer::Kind::kPong;
      next->nonce = *std::exchange(pong_, std::nullopt);
    } else if (!answers_.empty()) {
      next = std::move(answers_.front().answer);
      answers_.pop_front();
    }
    return next;
  }

  void Clear() {
    answers_.clear();
    pong_.reset();
  }

 private:
  struct Waiting {
    StreamAnswer answer;
    bool replaceable;
  };
  std::deque<Waiting> answers_;
  std::optional<std::uint64_t> pong_;
};

// How long a call that ends waits for its last write: whoever does not read keeps no place.
inline constexpr std::chrono::milliseconds kLastWrite = std::chrono::seconds(10);

// A message of the client. What of it is not for the policy stays where it was read.
struct StreamMessage {
  struct Open {};
  struct Update {
    std::uint64_t sequence = 0;
    std::vector<NamedTarget> targets;    // any of the handles
    std::span<const double> positions;   // or all of them in the order of the set, x y x y…
    Result<std::vector<Complex>> picks;  // to be mapped back to rest
    bool measure = false;                // the shape, in any case
  };
  struct Edit {
    std::uint64_t sequence = 0;
    std::size_t added = 0;   // handles
    bool has_areas = false;  // whether one of them holds an area
  };
  struct Ping {
    std::uint64_t nonce = 0;
  };

  std::size_t bytes = 0;  // as it was sent
  std::variant<std::monostate, Open, Update, Edit, Ping> payload;
};

// What to do next. Nothing: wait until something happens.
struct StreamRead {};  // read the next message; the one before is needed no more
struct StreamJob {     // run this job, and tell how it ended; there is no other meanwhile
  enum class Work { kOpen, kUpdate, kEdit };
  enum class Lane {
    kControl,  // may wait for the store
    kFrames,   // frames, and edits that cost about as much
    kJobs,     // what takes longer than kLongFrameSeconds
  };
  Work work = Work::kOpen;
  Lane lane = Lane::kControl;
  double seconds = 0;               // that it is expected to take
  std::uint64_t sequence = 0;       // kUpdate, kEdit
  std::span<const Target> targets;  // kUpdate: to go to; kEdit: the last ones. Until the job ends.
  std::vector<Complex> picks;       // kUpdate
  bool measure = true;              // kUpdate: the shape
  runtime::WallTimer waiting;       // since it was taken
};
struct StreamWrite {  // write this; no other write is under way
  StreamAnswer answer;
};
struct StreamFinish {  // end the call; nothing comes after it
  Status status;
};
using StreamStep = std::variant<std::monostate, StreamRead, StreamJob, StreamWrite, StreamFinish>;

// A handle set with where its handles go: when the stream opens, and after an edit.
struct LiveHandles {
  std::shared_ptr<const CompiledHandles> handles;
  std::vector<Target> targets;  // one per handle
};

// Not thread-safe. After each event ask Next until it answers nothing; do each step at once.
class StreamPolicy {
 public:
  struct Counts {
    std::uint64_t shapes = 0;
    std::uint64_t replaced = 0;
    std::uint64_t errors = 0;
  };
  // What admission says of frames that take this part of a worker (admission.h).
  struct Admit {
    std::function<Status(double share)> may_open;
    std::function<Status(double share)> wake_up;
    std::function<void(double share)> stays_awake;
  };
  // Extends the life of the session, or says that it is over (Session::Touch).
  using Touch = std::function<Status()>;

  // `limits` and `clock` outlive it.
  StreamPolicy(const Limits& limits, const runtime::Clock& clock, Admit admit);

  // What happens on the wire. The ids and positions of a message stay as they are until the next
  // StreamRead.
  void MessageRead(StreamMessage message);
  void HalfClosed();       // nothing more is to be read
  void Written(bool ok);   // the write has ended; false: nobody reads any more
  void Cancelled();        // the client has gone
  void End(Fault reason);  // from outside: the session is over, the server drains. The first counts
  // Time has passed. True when the call is to be cancelled: who says nothing for too long may not
  // read either, and a write that never ends must not keep the stream.
  [[nodiscard]] bool Sweep(runtime::Clock::Steady now);

  // How the job ended. Every one ends with one of these.
  void NoRoom();  // its lane was full: it has not run
  void Opened(LiveHandles set, bool latest, std::uint32_t measure_every, Touch touch,
              std::unique_ptr<WireAnswer> answer);
  void Moved(std::unique_ptr<WireAnswer> shape);
  void Edited(LiveHandles set, std::unique_ptr<WireAnswer> shape);
  void Failed(Fault fault);  // an open ends the stream, the others are answered
  // Before Opened: whether the stream could join those that are awake, with frames that are expected
  // to take so long.
  Status AdmitFrames(double frame_seconds);
  // Before Moved: what the frame took.
  void FrameTook(double seconds) { pace_->Took(seconds); }

  StreamStep Next();

  const Counts& counts() const { return counts_; }

 private:
  // An update that was taken and has not started.
  struct Accepted {
    std::uint64_t sequence = 0;
    std::vector<Complex> picks;
    runtime::WallTimer waiting;
  };

  // Each takes the held message, or leaves it held and answers false.
  bool Take();
  bool TakeUpdate(StreamMessage::Update& update);
  bool TakeEdit(const StreamMessage::Edit& edit);
  // Refuses the held message, when it is its turn.
  bool RefuseInTurn(std::uint64_t sequence, const Fault& fault);
  // Whether rate and load allow an update now; takes the rate's token.
  Status Grant();
  // The targets after the update, in merged_.
  Status Merge(const StreamMessage::Update& update);
  // Whether the shape of the update that starts now is measured.
  bool Measures();
  std::optional<StreamJob> Begin();
  std::optional<Status> Over() const;

  void Start(StreamJob job);
  void Refuse(std::uint64_t sequence, Fault fault);
  bool idle() const { return !work_ && !next_ && outbox_.empty(); }
  bool ending() const { return end_.has_value() || cancelled_ || finished_; }

  const Limits& limits_;
  const runtime::Clock& clock_;
  const Admit admit_;
  Touch touch_;

  std::optional<StreamMessage> held_;
  std::optional<Fault> held_fault_;  // what is wrong with it, once that is known
  bool granted_ = false;             // it has its token
  bool reading_ = false;
  bool reads_done_ = false;
  runtime::Clock::Steady heard_;  // when the client last said something
  runtime::TokenBucket rate_;
  std::optional<StreamPace> pace_;     // since it was opened
  runtime::Clock::Steady said_awake_;  // when admission last heard of it

  bool opened_ = false;  // an open was taken
  bool latest_ = true;
  std::uint32_t measure_every_ = 1;  // 0: none
  std::uint32_t unmeasured_ = 0;     // shapes since the last that was measured
  bool measure_next_ = true;         // whatever measure_every_ says
  LiveHandles set_;                  // the targets of the last update that was taken
  std::vector<Target> merged_;       // see Merge
  std::optional<Accepted> next_;
  std::uint64_t replaced_ = 0;

  std::optional<StreamJob::Work> work_;
  std::optional<StreamJob> start_;  // taken, to be started
  std::uint64_t job_sequence_ = 0;
  std::uint64_t job_replaced_ = 0;
  bool job_measured_ = true;
  std::vector<Target> job_targets_;  // the running job's

  StreamOutbox outbox_;
  bool writing_ = false;
  std::optional<Fault> end_;
  runtime::Clock::Steady ended_;  // with end_
  bool cancelled_ = false;
  bool finished_ = false;
  Counts counts_;
};

}  // namespace arap::app
