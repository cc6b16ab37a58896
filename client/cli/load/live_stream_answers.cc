// What a live stream makes of what comes.
#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "client/cli/load/live_stream.h"
#include "proto/convert/status.h"

namespace arap::cli {

using client::internal::FromWire;

void LiveStream::OnMessage(const Response& response) {
  const Moment now = Now();
  std::function<void()> opened;
  switch (response.payload_case()) {
    case Response::kShape: {
      auto shape = FromWire(response.shape(), asked_);
      const MutexLock lock(&mutex_);
      heard_ = now;
      TakeShape(response.shape().sequence(), std::move(shape), now);
      Pump(Now());
      return;
    }
    case Response::kError: {
      const MutexLock lock(&mutex_);
      heard_ = now;
      TakeError(response.error(), now);
      Pump(now);
      return;
    }
    case Response::kPong: {
      const MutexLock lock(&mutex_);
      heard_ = now;
      TakePong(response.pong().nonce(), now);
      Pump(now);
      return;
    }
    case Response::kOpened: {
      const MutexLock lock(&mutex_);
      heard_ = now;
      TakeOpened(response.opened(), now);
      opened = std::exchange(opened_, nullptr);
      Pump(now);
      break;
    }
    case Response::PAYLOAD_NOT_SET: {
      const MutexLock lock(&mutex_);
      Break("The server sent an empty message.");
      return;
    }
  }
  if (opened) opened();
}

void LiveStream::TakeOpened(const v1::StreamOpened& opened, Moment now) {
  if (state_ != State::kOpening) return Break("The server opened the stream twice.");
  const auto set = FromWire(opened.handle_set(), {kLoadSet, session_.mesh_id}, asked_.mesh);
  if (!set) return Break(set.error().message);
  state_ = State::kOpen;
  if (!std::exchange(was_open_, true)) {
    if (phase_->each_from_opening) StartSending(now);
    return;
  }
  tally().CountResumed();
  const std::vector<Request> again = log_->Messages();
  say_again_.assign(again.begin(), again.end());
  if (!trouble_) return;
  trouble_->opened = now;
  if (again.empty()) {
    trouble_.reset();
  } else {
    trouble_->last_said = client::internal::SequenceOf(again.back());
  }
}

bool LiveStream::IsNew(std::uint64_t sequence, bool good) {
  const bool fresh = !log_ || log_->Answered(sequence, good);
  if (trouble_ && (good || fresh) && sequence >= trouble_->last_said) trouble_.reset();
  return fresh;
}

std::optional<LiveStream::OnItsWay> LiveStream::TakeAnswered(std::uint64_t sequence) {
  const bool every = kind_.delivery == client::Delivery::kEvery;
  while (!on_their_way_.empty()) {
    OnItsWay message = on_their_way_.front();
    if (message.sequence > sequence) break;
    if (message.sequence < sequence) {
      // Newer updates take the place of older ones, and of nothing else.
      if (every || message.sent.operation == Operation::kEdit) break;
      if (!message.given_up) tally().CountReplaced(message.sent);
      NoteTaken(message);
    }
    on_their_way_.pop_front();
    if (!message.given_up) sender_->Answered();
    if (message.sequence == sequence) return message;
  }
  Break(fmt::format("The server answered the sequence {}, for which it was not asked.", sequence));
  return std::nullopt;
}

void LiveStream::TakeShape(std::uint64_t sequence, Result<client::Shape> shape, Moment now) {
  if (!IsNew(sequence, true)) return;
  const auto message = TakeAnswered(sequence);
  if (!message) return;
  NoteTaken(*message);
  if (message->given_up) return;
  if (!shape) {
    tally().CountFailed(message->sent, now);
    tally().CountBadReply(shape.error().message);
    return;
  }
  tally().CountAnswered(message->sent, now, ServerTimes{shape->queue_micros, shape->solve_micros});
  if (message->verify) Verify(*message, *std::move(shape));
}

void LiveStream::NoteTaken(const OnItsWay& message) {
  if (message.sent.operation == Operation::kDrag) {
    taken_ = message.number;
    return;
  }
  extra_there_ = !extra_there_;
  extra_since_ = extra_there_ ? taken_ : std::nullopt;
}

Verifier::Told LiveStream::Verdict(Operation operation) const {
  return [phase = phase_, stream = number_, operation](const Result<bool>& right) {
    Tally& tally = phase->TallyOf(stream);
    if (!right) return tally.CountError(right.error());
    tally.CountVerified(operation, *right);
    if (*right) return;
    tally.CountBadReply(
        fmt::format("The answer to a {} is not what was computed here.", NameOf(operation)));
  };
}

void LiveStream::Verify(const OnItsWay& message, client::Shape shape) {
  if (!taken_ || (extra_there_ && !extra_since_)) return;
  const auto targets = [this](std::uint64_t number) {
    return TargetsOf(kind_.scene, kind_.seed, number_, number);
  };
  Verifier::Pose pose{.targets = targets(*taken_), .deform = kind_.shape.deform};
  if (extra_there_) pose.extra_since = targets(*extra_since_);
  kind_.verifier->AskShape(std::move(pose), std::move(shape), Verdict(message.sent.operation));
}

void LiveStream::TakeError(const v1::UpdateError& error, Moment now) {
  const Fault fault = convert::FaultOf(error.status());
  if (!IsNew(error.sequence(), false)) return tally().CountError(fault);
  const auto message = TakeAnswered(error.sequence());
  if (!message) return;
  // A bad edit has changed nothing; of a drag some faults come after its targets were taken.
  if (message->sent.operation == Operation::kEdit) {
    extra_ = !extra_;
  } else {
    taken_.reset();
  }
  if (message->given_up) return;
  tally().CountFailed(message->sent, now);
  tally().CountError(fault);
}

void LiveStream::TakePong(std::uint64_t nonce, Moment now) {
  if (pings_.empty() || pings_.front().nonce != nonce) {
    return Break("The server answered a ping that was not sent.");
  }
  const Asked ping = pings_.front();
  pings_.pop_front();
  if (ping.given_up) return;
  tally().CountEcho(ping.intended, MicrosOf(now - ping.sent));
  if (echo_) echo_->Answered();
}

void LiveStream::OnSideAnswer(std::uint64_t ticket, Moment now, const Result<ServerTimes>& times) {
  const MutexLock lock(&mutex_);
  const auto found = beside_.find(ticket);
  if (found == beside_.end()) return;
  const Sent sent = found->second;
  beside_.erase(found);
  sender_->Answered();
  if (times) {
    tally().CountAnswered(sent, now, *times);
  } else {
    tally().CountFailed(sent, now);
    tally().CountError(times.error());
  }
  Pump(Now());
}

void LiveStream::Break(const std::string& sentence) {
  tally().CountBadReply(sentence);
  breach_ = client::internal::BadAnswer(sentence);
  if (call_ != nullptr) call_->Cancel();
}

}  // namespace arap::cli
