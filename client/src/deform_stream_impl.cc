#include "client/src/deform_stream_impl.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"

namespace arap::client {
namespace {

using convert::FaultOf;
using internal::FromWire;
using std::chrono::milliseconds;
using WallClock = std::chrono::system_clock;

double Seconds(milliseconds time) { return std::chrono::duration<double>(time).count(); }

Fault NotGrown(std::uint64_t sequence) {
  return Fault(FaultKind::kInvalidOption,
               fmt::format("The sequence {} has not grown; on a stream that resumes it tells the "
                           "answers apart.",
                           sequence))
      .Field("sequence");
}

Fault Closed() { return {FaultKind::kProtocol, "Sending on this stream was closed."}; }
Fault Over() { return {FaultKind::kProtocol, "The stream is over; reading tells why."}; }
Fault Cancelled() { return {FaultKind::kCancelled, "The stream was cancelled."}; }

}  // namespace

DeformStream::Impl::Impl(std::shared_ptr<internal::Channel> channel,
                         std::shared_ptr<internal::KnownSizes> sizes, const StreamOptions& options,
                         const CallOptions& call, v1::OpenStream open)
    : options_(options),
      deadline_(internal::DeadlineOf(call, kNoLimit)),
      headers_(open.session_id(), call.traceparent),
      open_message_(std::move(open)),
      channel_(std::move(channel)),
      sizes_(std::move(sizes)),
      asked_{options.shape},
      awaited_(options.delivery == Delivery::kEvery),
      life_(options.heartbeat, options.silence) {
  if (resumes()) log_.emplace(options_.delivery == Delivery::kLatest);
  watch_ = std::jthread([this] { Watch(); });
}

Status DeformStream::Impl::Open() {
  bool lost = false;
  TRY(handle_set_, OpenCall(&lost));
  asked_.mesh = sizes_->OfMesh(handle_set_.mesh_id);
  const MutexLock lock(&mutex_);
  waiting_since_.reset();
  open_ = true;
  return {};
}

Status DeformStream::Impl::Send(v1::StreamDeformRequest request) {
  std::shared_ptr<Call> call;
  {
    const MutexLock lock(&mutex_);
    if (sending_closed_) return Fail(Closed());
    const bool waits = options_.delivery == Delivery::kEvery;
    while (waits && !open_ && !end_ && !cancelled_) changed_.Wait(&mutex_);
    if (end_ || cancelled_) return Fail(Over());
    if (log_ && !log_->Sent(request)) return Fail(NotGrown(internal::SequenceOf(request)));
    if (!open_) return {};
    awaited_.Sent(request, Clock::now());
    call = call_;
    call->Push(std::move(request));
  }
  // What a lost call has not sent is said again on the next one.
  if (!call->WaitSent() && !resumes()) return Fail(Over());
  return {};
}

Status DeformStream::Impl::Ping(std::uint64_t nonce) {
  const MutexLock lock(&mutex_);
  if (sending_closed_) return Fail(Closed());
  if (end_ || cancelled_) return Fail(Over());
  PushPing(nonce);
  return {};
}

Status DeformStream::Impl::CloseSending() {
  const MutexLock lock(&mutex_);
  if (std::exchange(sending_closed_, true)) return {};
  if (end_ || cancelled_) return Fail(Over());
  if (open_) call_->PushEnd();
  return {};
}

void DeformStream::Impl::Cancel() {
  const MutexLock lock(&mutex_);
  cancelled_ = true;
  if (call_) call_->Cancel();
  changed_.SignalAll();
}

void DeformStream::Impl::End(Status status) {
  const MutexLock lock(&mutex_);
  end_ = std::move(status);
  open_ = false;
  changed_.SignalAll();
}

bool DeformStream::Impl::Next(Call& call, v1::StreamDeformResponse* response) {
  const auto wait = [this](bool waiting) {
    const MutexLock lock(&mutex_);
    life_.SetWaiting(waiting, Clock::now());
  };
  wait(true);
  const bool got = call.Read(response);
  wait(false);
  return got;
}

Status DeformStream::Impl::EndOf(const Call& call, bool* lost) {
  const MutexLock lock(&mutex_);
  *lost = !overdue_ && (silent_ || internal::IsLost(call.status()));
  if ((*lost || overdue_) && cancelled_) {
    *lost = false;
    return Fail(Cancelled());
  }
  if (overdue_) return Fail(*overdue_);
  if (*lost && silent_) {
    Fault fault(FaultKind::kDraining, fmt::format("Nothing was heard from the server for {:g} s.",
                                                  Seconds(options_.silence)));
    return Fail(fault.Detail(std::string(kGrpcCodeDetail), "UNAVAILABLE"));
  }
  if (!call.status().ok()) return Fail(FaultOf(call.status()));
  if (!awaited_.oldest()) return {};
  return Fail(
      internal::BadAnswer("The server ended the stream early: what was sent on it has no answer."));
}

Result<std::optional<StreamEvent>> DeformStream::Impl::Read() {
  for (;;) {
    std::shared_ptr<Call> call;
    {
      const MutexLock lock(&mutex_);
      if (end_ && !*end_) return Fail(end_->error());
      if (end_) return std::optional<StreamEvent>();
      call = call_;
      if (!waiting_since_) waiting_since_ = Clock::now();
    }
    v1::StreamDeformResponse response;
    bool lost = false;
    Status end;
    if (Next(*call, &response)) {
      auto event = EventOf(response);
      if (event && *event) {
        const MutexLock lock(&mutex_);
        waiting_since_.reset();
        return event;
      }
      if (event) continue;
      call->Cancel();
      lost = internal::IsFull(event.error());
      end = Fail(std::move(event.error()));
    } else {
      end = EndOf(*call, &lost);
    }
    call.reset();
    if (lost && resumes()) {
      auto resumed = Resume(std::move(end.error()));
      if (resumed) return std::optional<StreamEvent>(*std::move(resumed));
      end = Fail(std::move(resumed.error()));
    }
    End(std::move(end));
  }
}

bool DeformStream::Impl::Known(std::uint64_t sequence, bool good) {
  const bool seen = log_ && !log_->Answered(sequence, good);
  if (trouble_ && (good || !seen) && sequence >= trouble_->last_said) trouble_.reset();
  return seen;
}

Result<std::optional<StreamEvent>> DeformStream::Impl::EventOf(
    const v1::StreamDeformResponse& response) {
  switch (response.payload_case()) {
    case v1::StreamDeformResponse::kShape:
      return ShapeOf(response.shape());
    case v1::StreamDeformResponse::kError: {
      Fault fault = FaultOf(response.error().status());
      const MutexLock lock(&mutex_);
      CHECK_OK(awaited_.Take(response.error().sequence()));
      // What had worked does not work again: the shapes would be others.
      if (Known(response.error().sequence(), false)) return Fail(std::move(fault));
      return std::optional<StreamEvent>(UpdateError{response.error().sequence(), std::move(fault)});
    }
    case v1::StreamDeformResponse::kPong:
      return TakePong(response.pong().nonce());
    case v1::StreamDeformResponse::kOpened:
    case v1::StreamDeformResponse::PAYLOAD_NOT_SET:
      break;
  }
  return Fail(FaultKind::kInternal, "The server sent a message that does not belong here.");
}

Result<std::optional<StreamEvent>> DeformStream::Impl::ShapeOf(const v1::Shape& message) {
  {
    const MutexLock lock(&mutex_);
    TRY(const auto asked, awaited_.Take(message.sequence()));
    const std::uint32_t every = options_.shape.deform.measure_every;
    asked_.picks = asked.picks;
    asked_.measured = asked.measured || (every > 0 && unmeasured_ + 1 >= every);
    unmeasured_ = message.unmeasured() && every > 0 ? unmeasured_ + 1 : 0;
    if (Known(message.sequence(), true)) return std::optional<StreamEvent>();
  }
  TRY(Shape shape, FromWire(message, asked_));
  // Of a mesh that was never seen, the shapes have at least one size.
  if (!asked_.mesh && asked_.vertices.empty()) {
    asked_.mesh = {shape.positions.size(), std::numeric_limits<std::size_t>::max()};
  }
  return std::optional<StreamEvent>(std::move(shape));
}

Result<HandleSetInfo> DeformStream::Impl::OpenCall(bool* lost) {
  const auto call = Call::Start(channel_, [this](grpc::ClientContext& context) {
    headers_.AddTo(context);
    if (deadline_) context.set_deadline(*deadline_);
  });
  v1::StreamDeformRequest request;
  *request.mutable_open() = open_message_;
  call->Push(std::move(request));
  std::shared_ptr<Call> old;  // may have to end yet, which is not to be waited for with mutex_ held
  {
    const MutexLock lock(&mutex_);
    old = std::exchange(call_, call);
    silent_ = false;
    waiting_since_ = Clock::now();
    life_.Restart(Clock::now());
    if (cancelled_) call->Cancel();
  }
  old.reset();
  // The server may have much to compute before it has opened; meanwhile it answers pings.
  v1::StreamDeformResponse response;
  while (Next(*call, &response)) {
    if (response.has_opened()) {
      const v1::HandleSetInfo& set = response.opened().handle_set();
      const auto mesh = sizes_->OfMesh(set.mesh_id());
      TRY(auto info, FromWire(set, {open_message_.handle_set_id()}, mesh));
      CHECK_OK(TakeVertices(
          internal::VerticesFromWire(response.opened().vertices(), options_.shape, mesh)));
      sizes_->KnowSet(info.id, info.mesh_id);
      unmeasured_ = std::max(options_.shape.deform.measure_every, 1u) - 1;
      return info;
    }
    if (!response.has_pong()) {
      return Fail(FaultKind::kInternal, "The server answered before it opened the stream.");
    }
    CHECK_OK(TakePong(response.pong().nonce()));
  }
  CHECK_OK(EndOf(*call, lost));
  return Fail(FaultKind::kInternal, "The server ended the stream without opening it.");
}

Status DeformStream::Impl::TakeVertices(Result<std::vector<std::uint32_t>> answered) {
  TRY(auto vertices, std::move(answered));
  if (!asked_.vertices.empty() && vertices != asked_.vertices) {
    return Fail(internal::BadAnswer("The server answered another boundary than before the loss."));
  }
  asked_.vertices = std::move(vertices);
  return {};
}

Result<StreamEvent> DeformStream::Impl::Resume(Fault fault) {
  bool silent = false;
  {
    const MutexLock lock(&mutex_);
    open_ = false;
    silent = silent_;
  }
  // Who is lost again before it has caught up comes back neither at once nor for ever.
  const bool again = trouble_ && Clock::now() - trouble_->opened < options_.resume_within;
  if (!again) trouble_ = Trouble{Clock::now() + options_.resume_within, {}};
  for (std::uint32_t attempts = 1;; ++attempts) {
    if (again || attempts > 1) {
      CHECK_OK(Pause(fault));
    }
    if (silent) channel_ = channel_->Another();
    bool lost = false;
    auto opened = OpenCall(&lost);
    const MutexLock lock(&mutex_);
    if (opened) {
      SayAgain();
      return Resumed{*std::move(opened), attempts};
    }
    fault = std::move(opened.error());
    if (!lost && !internal::IsFull(fault)) return Fail(std::move(fault));
    silent = silent_;
  }
}

Status DeformStream::Impl::Pause(const Fault& last) {
  milliseconds pause = trouble_->backoff.Next();
  if (Clock::now() + pause >= trouble_->until) return Fail(last);
  if (deadline_) {
    const auto left = *deadline_ - WallClock::now();
    pause = std::min(pause, std::chrono::ceil<milliseconds>(left));
  }
  const Clock::time_point end = Clock::now() + pause;
  const MutexLock lock(&mutex_);
  while (!cancelled_) {
    if (changed_.WaitUntil(&mutex_, end)) return {};
  }
  return Fail(Cancelled());
}

void DeformStream::Impl::SayAgain() {
  std::vector<v1::StreamDeformRequest> messages = log_->Messages();
  if (messages.empty()) {
    trouble_.reset();
  } else {
    trouble_->opened = Clock::now();
    trouble_->last_said = internal::SequenceOf(messages.back());
  }
  awaited_.Restart(messages, Clock::now());
  for (v1::StreamDeformRequest& message : messages) call_->Push(std::move(message));
  open_ = true;
  for (const std::uint64_t nonce : life_.Unanswered()) SendPing(nonce);
  if (sending_closed_) call_->PushEnd();
  changed_.SignalAll();
}

void DeformStream::Impl::SendPing(std::uint64_t nonce) {
  v1::StreamDeformRequest request;
  request.mutable_ping()->set_nonce(nonce);
  call_->Push(std::move(request));
}

void DeformStream::Impl::PushPing(std::optional<std::uint64_t> nonce) {
  life_.Ask(nonce, open_, Clock::now());
  if (open_ || !nonce) SendPing(nonce.value_or(0));
}

Result<std::optional<StreamEvent>> DeformStream::Impl::TakePong(std::uint64_t nonce) {
  const MutexLock lock(&mutex_);
  if (!life_.IsDueAnswer(nonce)) {
    return Fail(internal::BadAnswer("The server answered a ping that was not sent."));
  }
  if (!life_.Answered()) return std::optional<StreamEvent>();
  return std::optional<StreamEvent>(Pong{nonce});
}

std::optional<Fault> DeformStream::Impl::Overdue(Clock::time_point now) const {
  const auto fault = [&](const char* what) {
    return Fault(FaultKind::kDeadlineExceeded,
                 fmt::format("The server has not {} for {:g} s.", what, Seconds(options_.answer)));
  };
  const auto stuck = call_->writing_since();
  if (stuck && now - *stuck >= options_.answer) return fault("taken a message");
  if (!waiting_since_ || now - *waiting_since_ < options_.answer) return std::nullopt;
  if (!open_) return fault("opened the stream");
  if (const auto oldest = awaited_.oldest()) {
    if (now - *oldest < options_.answer) return std::nullopt;
    return fault("answered an update or edit");
  }
  if (sending_closed_) return fault("ended the stream");
  return std::nullopt;
}

void DeformStream::Impl::Watch() {
  const bool asks = options_.heartbeat.count() > 0;
  const milliseconds shortest =
      asks ? std::min({options_.heartbeat, options_.silence, options_.answer}) : options_.answer;
  const auto tick = std::clamp(shortest / 2, milliseconds(1), milliseconds(std::chrono::hours(1)));
  const MutexLock lock(&mutex_);
  while (!end_ && !cancelled_) {
    const Clock::time_point now = Clock::now();
    if (call_ && asks && life_.IsSilent(now)) {
      silent_ = true;
      call_->Cancel();
    } else if (call_ && !overdue_ && (overdue_ = Overdue(now))) {
      call_->Cancel();
    } else if (call_ && asks && !(open_ && sending_closed_) &&
               life_.IsDue(call_->is_clear(), now)) {
      PushPing(std::nullopt);
    }
    const Clock::time_point next = now + tick;
    while (!end_ && !cancelled_ && !changed_.WaitUntil(&mutex_, next)) {
    }
  }
}

}  // namespace arap::client
