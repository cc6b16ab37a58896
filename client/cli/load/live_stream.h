// LiveStream: one stream of a load generator: what it sends, what it makes of what comes, and how it
// goes on after a loss.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arap/client/client.h"
#include "client/cli/load/chance.h"
#include "client/cli/load/load_session.h"
#include "client/cli/load/pacer.h"
#include "client/cli/load/scene.h"
#include "client/cli/load/schedule.h"
#include "client/cli/load/side_calls.h"
#include "client/cli/load/tally.h"
#include "client/cli/load/verifier.h"
#include "client/cli/load/wire_call.h"
#include "client/src/answers.h"
#include "client/src/calls.h"
#include "client/src/replay_log.h"
#include "core/base/mutex.h"

namespace arap::cli {

// What all streams have in common, for as long as they are.
struct StreamKind {
  const LoadScene& scene;
  client::ShapeOptions shape;
  client::Delivery delivery = client::Delivery::kEvery;
  Mix mix;
  std::uint64_t seed = 0;
  double verify = 0;  // which part of the answers is computed here too
  // As those of client::StreamOptions.
  std::chrono::milliseconds resume_within{0}, silence{0};
  Verifier* verifier = nullptr;  // or none
  SideCalls* side_calls = nullptr;
  Pacer* pacer = nullptr;
  Gate* gate = nullptr;
  Bell* bell = nullptr;  // rings when a stream is done with its phase, and when it is over
};

// A stretch of time in which streams send in one way.
struct LoadPhase {
  Moment begin{0}, end{0};
  std::size_t streams = 1;
  // Of all streams together, from `begin` on; null for a closed loop.
  std::shared_ptr<const RateProfile> profile;
  // Each stream has the profile to itself, from when it was opened on, and sends until then plus the
  // length of the phase.
  bool each_from_opening = false;
  bool poisson = false;
  std::size_t window = 1;
  std::optional<std::uint64_t> most;            // messages of all streams together
  std::shared_ptr<const RateProfile> echo;      // of pings; null: none
  std::vector<std::unique_ptr<Tally>> tallies;  // a stream uses its number modulo their count

  Tally& TallyOf(std::size_t stream) const { return *tallies[stream % tallies.size()]; }
};

// Thread-safe; callbacks of gRPC and of the pacer meet in it. Its lock is never held while a shape is
// decoded, so that nobody waits for that but who reads the stream. Memory: the call (wire_call.h),
// the messages on their way at some 60 bytes each, and when it resumes a copy of each of these.
class LiveStream final : public WireCall::Owner {
 public:
  // An open loop goes on for so long behind its end with what was due before it: the last messages are
  // sent a little late by any machine, and are no sign of a backlog.
  static constexpr Moment kTail = std::chrono::milliseconds(100);

  LiveStream(const StreamKind& kind, std::size_t number, const LoadSession& session,
             LoadConnection& connection);
  // After the gate is empty and the pacer gone.
  ~LiveStream() override = default;
  LiveStream(const LiveStream&) = delete;
  LiveStream& operator=(const LiveStream&) = delete;

  // Begins to open; `opened` is called when it is open or will not be. False without a session: then
  // it is over.
  bool Open(std::shared_ptr<const LoadPhase> phase, std::function<void()> opened);
  // It sends as the phase says, from its beginning on.
  void Begin(std::shared_ptr<const LoadPhase> phase);
  // The pacer's call.
  void Wake();
  // Nothing more is sent in this phase; what was due counts as unsent.
  void StopSending();
  // What has no answer by now counts as failed; answers that come yet are passed over. How many there
  // are.
  std::size_t GiveUpWaiting();
  // Ends it: the server answers what is pending and ends the call.
  void Close();
  void Cancel();
  // Asks now and then whether the server has been silent for too long.
  void Look();

  bool is_over() const;
  // Whether it has nothing to send any more in this phase, and nothing on its way.
  bool is_done() const;
  // How many messages, pings and calls went out since the stream began.
  std::uint64_t messages() const;

 private:
  using Request = v1::StreamDeformRequest;
  using Response = v1::StreamDeformResponse;

  enum class State {
    kNew,
    kOpening,
    kOpen,
    kLost,  // to be opened again at reopen_at_
    kOver,
  };
  struct OnItsWay {
    std::uint64_t sequence = 0;
    std::uint64_t number = 0;  // of the stream's messages, which says where the handles are
    Sent sent;
    bool verify = false;
    bool given_up = false;  // counted as failed: its answer is passed over
  };
  struct Asked {
    std::uint64_t nonce = 0;
    Moment intended{0}, sent{0};
    bool given_up = false;
  };
  // From a loss until the server has answered what was said again.
  struct Trouble {
    Moment until{0}, opened{0};
    client::internal::Backoff backoff;
    std::uint64_t last_said = 0;
  };

  void OnMessage(const Response& response) override;
  void OnWritten(bool ok) override;
  void OnReadEnd() override;
  void OnOver(const grpc::Status& status) override;

  void StartCall(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void StartSending(Moment begin) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Sends whatever is due and may be sent, makes an appointment for what comes next, and rings when nothing
  // does.
  void Pump(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void SendWhatIsDue(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsDone() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void RingWhenDone() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Appoint(Moment when, Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void SendDue(const Sender::Due& due, Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void StartBeside(const Sent& sent, std::uint64_t number, bool verify)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The end of a call beside the stream.
  void OnSideAnswer(std::uint64_t ticket, Moment now, const Result<ServerTimes>& times);
  void SendPing(const Sender::Due& due, Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void FillDrag(std::uint64_t number, v1::HandleUpdate& update) const;
  void FillEdit(v1::HandleEdit& edit) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Write() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  void TakeOpened(const v1::StreamOpened& opened, Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TakeShape(std::uint64_t sequence, Result<client::Shape> shape, Moment now)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TakeError(const v1::UpdateError& error, Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TakePong(std::uint64_t nonce, Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The server has the update or the edit now, in the order of its answers.
  void NoteTaken(const OnItsWay& message) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Counts whether an answer was right.
  Verifier::Told Verdict(Operation operation) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Verify(const OnItsWay& message, client::Shape shape) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The message that was answered, less those that it has replaced; nothing when none was due.
  std::optional<OnItsWay> TakeAnswered(std::uint64_t sequence)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // False when the answer is one of what was said again after a loss.
  bool IsNew(std::uint64_t sequence, bool good) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The stream cannot go on: what it was sent does not fit.
  void Break(const std::string& sentence) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  Fault Silence() const;
  // Tries to open again, now or later; false when it is too late for that.
  bool PlanReopening(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void FailAll(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void StopSending(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void End(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Tally& tally() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return phase_->TallyOf(number_); }

  const StreamKind& kind_;
  const std::size_t number_;
  const LoadSession& session_;
  LoadConnection& connection_;
  const client::internal::CallHeaders headers_;
  const client::internal::ShapeQuestion asked_;

  mutable Mutex mutex_;
  State state_ ABSL_GUARDED_BY(mutex_) = State::kNew;
  std::shared_ptr<const LoadPhase> phase_ ABSL_GUARDED_BY(mutex_);
  std::function<void()> opened_ ABSL_GUARDED_BY(mutex_);
  WireCall* call_ ABSL_GUARDED_BY(mutex_) = nullptr;  // while it may be used
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool broken_ ABSL_GUARDED_BY(mutex_) = false;  // call_ takes no more messages
  bool closing_ ABSL_GUARDED_BY(mutex_) = false, end_sent_ ABSL_GUARDED_BY(mutex_) = false;
  bool silent_ ABSL_GUARDED_BY(mutex_) = false;  // for so long that call_ was given up
  bool was_open_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<Fault> breach_ ABSL_GUARDED_BY(mutex_);  // why it was given up for good
  std::uint64_t channel_number_ ABSL_GUARDED_BY(mutex_) = 0;
  Moment asked_at_ ABSL_GUARDED_BY(mutex_){0};  // when the call was begun
  Moment heard_ ABSL_GUARDED_BY(mutex_){0};
  std::optional<Trouble> trouble_ ABSL_GUARDED_BY(mutex_);
  Moment reopen_at_ ABSL_GUARDED_BY(mutex_){0};
  std::deque<Request> say_again_ ABSL_GUARDED_BY(mutex_);
  std::optional<client::internal::ReplayLog> log_ ABSL_GUARDED_BY(mutex_);  // when it resumes

  std::optional<Sender> sender_ ABSL_GUARDED_BY(mutex_), echo_ ABSL_GUARDED_BY(mutex_);
  Moment appointed_ ABSL_GUARDED_BY(mutex_) = kNever;
  bool rung_ ABSL_GUARDED_BY(mutex_) = false;  // in this phase
  std::uint64_t sequence_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t before_ ABSL_GUARDED_BY(mutex_) = 0;  // messages of earlier phases
  bool extra_ ABSL_GUARDED_BY(mutex_) = false;        // whether edits have added the further handle
  // As far as the server has answered: the number of the last drag, which is where its handles are; whether
  // the further handle is there, and since which drag. Nothing where that is not known.
  std::optional<std::uint64_t> taken_ ABSL_GUARDED_BY(mutex_);
  bool extra_there_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<std::uint64_t> extra_since_ ABSL_GUARDED_BY(mutex_);
  std::deque<OnItsWay> on_their_way_ ABSL_GUARDED_BY(mutex_);
  std::map<std::uint64_t, Sent> beside_ ABSL_GUARDED_BY(mutex_);  // calls, by their tickets
  std::deque<Asked> pings_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t nonces_ ABSL_GUARDED_BY(mutex_) = 0, tickets_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t messages_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace arap::cli
