// What a live stream sends, and its life; live_stream_answers.cc has what it makes of what comes.
#include "client/cli/load/live_stream.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "client/cli/load/chance.h"
#include "proto/convert/deform.h"
#include "proto/convert/plain.h"
#include "proto/convert/status.h"

namespace arap::cli {
namespace {

std::uint64_t ShareOf(std::uint64_t most, std::size_t stream, std::size_t streams) {
  return most / streams + (stream < most % streams ? 1 : 0);
}

// How a call has ended that nobody here has ended.
Fault FaultOf(const grpc::Status& status) {
  if (!status.ok()) return convert::FaultOf(status);
  return client::internal::BadAnswer("The server ended the stream.");
}

}  // namespace

LiveStream::LiveStream(const StreamKind& kind, std::size_t number, const LoadSession& session,
                       LoadConnection& connection)
    : kind_(kind),
      number_(number),
      session_(session),
      connection_(connection),
      headers_(session.id),
      asked_{.options = kind.shape,
             .mesh = client::internal::MeshSize{kind.scene.mesh.vertices.size(),
                                                kind.scene.mesh.triangles.size()},
             .measured = kind.shape.deform.measure_every == 1} {}

bool LiveStream::Open(std::shared_ptr<const LoadPhase> phase, std::function<void()> opened) {
  const MutexLock lock(&mutex_);
  phase_ = std::move(phase);
  if (session_.id.empty()) {
    state_ = State::kOver;
    return false;
  }
  opened_ = std::move(opened);
  if (kind_.resume_within.count() > 0) log_.emplace(kind_.delivery == client::Delivery::kLatest);
  StartCall(Now());
  return true;
}

void LiveStream::StartCall(Moment now) {
  const auto [channel, number] = connection_.Get();
  channel_number_ = number;
  state_ = State::kOpening;
  asked_at_ = heard_ = now;
  silent_ = broken_ = end_sent_ = false;
  call_ = WireCall::Start(*channel, *this, *kind_.gate,
                          [this](grpc::ClientContext& context) { headers_.AddTo(context); });
  v1::OpenStream& open = *call_->outgoing().mutable_open();
  open.set_session_id(session_.id);
  open.set_handle_set_id(kLoadSet);
  open.set_delivery(kind_.delivery == client::Delivery::kEvery ? v1::DELIVERY_EVERY
                                                               : v1::DELIVERY_LATEST);
  client::internal::ToWire(kind_.shape, open.mutable_options());
  Write();
}

void LiveStream::Write() {
  writing_ = true;
  call_->Write();
}

void LiveStream::Begin(std::shared_ptr<const LoadPhase> phase) {
  const MutexLock lock(&mutex_);
  phase_ = std::move(phase);
  StartSending(phase_->begin);
  const Moment now = Now();
  if (state_ == State::kOver) {
    End(now);
  } else {
    Pump(now);
  }
}

void LiveStream::StartSending(Moment begin) {
  const LoadPhase& phase = *phase_;
  rung_ = false;
  if (sender_) before_ += sender_->taken();
  Sender::Options options{begin, begin + (phase.end - phase.begin), phase.window};
  if (phase.most) options.most = ShareOf(*phase.most, number_, phase.streams);
  if (phase.profile) {
    const bool alone = phase.each_from_opening;
    const ArrivalShare share{number_, alone ? 1 : phase.streams, phase.poisson, kind_.seed, alone};
    sender_.emplace(options, Arrivals(phase.profile, share));
  } else {
    sender_.emplace(options);
  }
  echo_.reset();
  if (!phase.echo) return;
  options = {begin, options.end, kMostOnTheirWay};
  echo_.emplace(options, Arrivals(phase.echo, {number_, phase.streams, false, kind_.seed}));
}

void LiveStream::Wake() {
  const Moment now = Now();
  const MutexLock lock(&mutex_);
  if (now >= appointed_) appointed_ = kNever;
  Pump(now);
}

void LiveStream::Appoint(Moment when, Moment now) {
  if (when == kNever || (appointed_ <= when && appointed_ > now)) return;
  appointed_ = when;
  kind_.pacer->At(number_, when);
}

void LiveStream::Pump(Moment now) {
  SendWhatIsDue(now);
  RingWhenDone();
}

void LiveStream::RingWhenDone() {
  if (IsDone() && !std::exchange(rung_, true)) kind_.bell->Ring();
}

void LiveStream::SendWhatIsDue(Moment now) {
  if (state_ == State::kLost && !closing_) {
    if (now >= reopen_at_) return StartCall(now);
    return Appoint(reopen_at_, now);
  }
  if (state_ != State::kOpen || call_ == nullptr || broken_) return;
  while (!writing_) {
    if (!say_again_.empty()) {
      call_->outgoing() = std::move(say_again_.front());
      say_again_.pop_front();
      Write();
      return;
    }
    if (closing_) {
      if (!std::exchange(end_sent_, true)) call_->EndWriting();
      return;
    }
    if (!sender_) return;
    if (now > sender_->end() + kTail) StopSending(now);
    const Moment message = sender_->NextDue();
    const Moment ping = echo_ ? echo_->NextDue() : kNever;
    if (std::min(message, ping) > now) return Appoint(std::min(message, ping), now);
    if (ping < message) {
      if (const auto due = echo_->Take(now)) SendPing(*due, now);
    } else if (const auto due = sender_->Take(now)) {
      SendDue(*due, now);
    }
  }
}

void LiveStream::SendDue(const Sender::Due& due, Moment now) {
  const std::uint64_t number = before_ + due.number;
  const Operation operation = kind_.mix.At(kind_.seed, number_, number);
  const Sent sent{operation, due.intended, now};
  tally().CountSent(sent);
  ++messages_;
  const bool verify = kind_.verifier != nullptr &&
                      DrawPart(kind_.seed, Draw::kVerify, number_, number) < kind_.verify;
  if (operation != Operation::kDrag && operation != Operation::kEdit) {
    return StartBeside(sent, number, verify);
  }
  if (on_their_way_.empty()) heard_ = now;
  const std::uint64_t sequence = ++sequence_;
  v1::StreamDeformRequest& request = call_->outgoing();
  OnItsWay& message = on_their_way_.emplace_back();
  message.sequence = sequence;
  message.number = number;
  message.sent = sent;
  message.verify = verify;
  if (operation == Operation::kDrag) {
    request.mutable_update()->set_sequence(sequence);
    FillDrag(number, *request.mutable_update());
  } else {
    request.mutable_edit()->set_sequence(sequence);
    FillEdit(*request.mutable_edit());
  }
  if (log_) log_->Sent(request);
  Write();
}

void LiveStream::FillDrag(std::uint64_t number, v1::HandleUpdate& update) const {
  const std::vector<Complex> targets = TargetsOf(kind_.scene, kind_.seed, number_, number);
  update.clear_targets();
  update.clear_positions();
  if (!kind_.mix.Has(Operation::kEdit)) {
    convert::AppendPoints(targets, update.mutable_positions());
    return;
  }
  // By name, so that it does not matter whether the further handle is there.
  for (std::size_t k = 0; k < targets.size(); ++k) {
    convert::ToWire(HandleTarget{kind_.scene.handles[k].id, {targets[k]}}, update.add_targets());
  }
}

void LiveStream::FillEdit(v1::HandleEdit& edit) {
  edit.clear_add();
  edit.clear_remove();
  if (extra_) {
    edit.add_remove(kind_.scene.extra.id);
  } else {
    convert::ToWire(kind_.scene.extra, edit.add_add());
  }
  extra_ = !extra_;
}

void LiveStream::SendPing(const Sender::Due& due, Moment now) {
  ++messages_;
  pings_.push_back({++nonces_, due.intended, now});
  call_->outgoing().mutable_ping()->set_nonce(nonces_);
  Write();
}

void LiveStream::StartBeside(const Sent& sent, std::uint64_t number, bool verify) {
  const std::uint64_t ticket = ++tickets_;
  beside_.emplace(ticket, sent);
  // Streams and calls do not have the same of anything.
  const std::uint64_t unlike = DrawBits(kind_.seed, Draw::kMotion, number_, number);
  kind_.side_calls->Start(
      sent.operation, session_, unlike,
      [this, ticket](Moment now, const Result<ServerTimes>& times) {
        OnSideAnswer(ticket, now, times);
      },
      verify ? Verdict(sent.operation) : Verifier::Told());
}

void LiveStream::OnWritten(bool ok) {
  const Moment now = Now();
  const MutexLock lock(&mutex_);
  writing_ = false;
  broken_ = broken_ || !ok;
  Pump(now);
}

void LiveStream::OnReadEnd() {
  const MutexLock lock(&mutex_);
  call_ = nullptr;
}

void LiveStream::OnOver(const grpc::Status& status) {
  const Moment now = Now();
  std::function<void()> opened;
  {
    const MutexLock lock(&mutex_);
    call_ = nullptr;
    writing_ = false;
    const bool lost = !breach_ && (silent_ || client::internal::IsLost(status));
    const Fault fault = breach_ ? *breach_ : silent_ ? Silence() : FaultOf(status);
    const bool again = was_open_ && (lost || (trouble_ && client::internal::IsFull(fault)));
    if (silent_) connection_.Replace(channel_number_);
    if (!closing_ && again && PlanReopening(now)) return;
    if (!was_open_ && fault.kind == FaultKind::kLimitExceeded) {
      tally().CountRefused(MicrosOf(now - asked_at_));
    }
    if (!closing_ && !breach_) tally().CountError(fault);
    if (trouble_) tally().CountLost(on_their_way_.size());
    opened = std::exchange(opened_, nullptr);
    End(now);
  }
  if (opened) opened();
}

Fault LiveStream::Silence() const {
  const double seconds = std::chrono::duration<double>(kind_.silence).count();
  Fault fault(FaultKind::kDraining,
              fmt::format("Nothing was heard from the server for {:g} s.", seconds));
  return fault.Detail(std::string(kGrpcCodeDetail), "UNAVAILABLE");
}

bool LiveStream::PlanReopening(Moment now) {
  if (!log_) return false;
  const Moment within = kind_.resume_within;
  // Who is lost again before it has caught up comes back neither at once nor for ever.
  const bool again = trouble_ && (state_ == State::kOpening || now - trouble_->opened < within);
  if (!again) trouble_ = Trouble{now + within, now, {}};
  reopen_at_ = now + (again ? Moment(trouble_->backoff.Next()) : Moment(0));
  if (reopen_at_ >= trouble_->until) return false;
  state_ = State::kLost;
  // Their answers were lost with the call.
  for (const Asked& ping : std::exchange(pings_, {})) {
    if (!ping.given_up && echo_) echo_->Answered();
  }
  Appoint(reopen_at_, Moment(0));
  return true;
}

void LiveStream::End(Moment now) {
  state_ = State::kOver;
  FailAll(now);
  // What would have been due on it is unsent, to the end of the phase.
  if (sender_) StopSending(kNever);
  kind_.bell->Ring();
}

void LiveStream::StopSending(Moment now) {
  sender_->Close(now, [&](const Sender::Due& due) {
    mutex_.AssertHeld();
    tally().CountUnsent(kind_.mix.At(kind_.seed, number_, before_ + due.number), due.intended);
  });
  if (echo_) echo_->Close(now, [](const Sender::Due&) {});
}

void LiveStream::FailAll(Moment now) {
  for (OnItsWay& message : on_their_way_) {
    if (std::exchange(message.given_up, true)) continue;
    tally().CountFailed(message.sent, now);
    sender_->Answered();
  }
  for (Asked& ping : pings_) {
    if (!std::exchange(ping.given_up, true) && echo_) echo_->Answered();
  }
}

void LiveStream::StopSending() {
  const Moment now = Now();
  const MutexLock lock(&mutex_);
  if (sender_) StopSending(now);
  RingWhenDone();
}

std::size_t LiveStream::GiveUpWaiting() {
  const Moment now = Now();
  const MutexLock lock(&mutex_);
  if (!sender_) return 0;
  const std::size_t waited = sender_->on_their_way();
  FailAll(now);
  for (const auto& [ticket, sent] : std::exchange(beside_, {})) {
    tally().CountFailed(sent, now);
    sender_->Answered();
  }
  return waited;
}

void LiveStream::Close() {
  const MutexLock lock(&mutex_);
  closing_ = true;
  if (state_ == State::kOpen) {
    Pump(Now());
  } else if (call_ != nullptr) {
    call_->Cancel();
  } else {
    state_ = State::kOver;
  }
}

void LiveStream::Cancel() {
  const MutexLock lock(&mutex_);
  closing_ = true;
  if (call_ != nullptr) call_->Cancel();
}

void LiveStream::Look() {
  const Moment now = Now();
  const MutexLock lock(&mutex_);
  const bool waits = state_ == State::kOpening || !on_their_way_.empty() || !pings_.empty();
  if (call_ == nullptr || silent_ || !waits || now - heard_ < kind_.silence) return;
  silent_ = true;
  call_->Cancel();
}

bool LiveStream::is_over() const {
  const MutexLock lock(&mutex_);
  return state_ == State::kOver;
}

bool LiveStream::is_done() const {
  const MutexLock lock(&mutex_);
  return IsDone();
}

bool LiveStream::IsDone() const {
  return state_ == State::kOver ? beside_.empty() : sender_ && sender_->is_done();
}

std::uint64_t LiveStream::messages() const {
  const MutexLock lock(&mutex_);
  return messages_;
}

}  // namespace arap::cli
