#include "client/cli/load/tally.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "client/cli/report.h"

namespace arap::cli {

bool StabilityRule::Agree(const Values& values) const {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(kSeconds);
  return mean > 0 && std::all_of(values.begin(), values.end(), [&](double value) {
           return std::abs(value - mean) <= within_ * mean;
         });
}

bool StabilityRule::Add(double answered, double median) {
  answered_[seen_ % kSeconds] = answered;
  medians_[seen_ % kSeconds] = median;
  ++seen_;
  return seen_ >= kSeconds && Agree(answered_) && Agree(medians_);
}

Tally::Tally(Moment from, std::shared_ptr<const RateProfile> steps)
    : from_(from), profile_(std::move(steps)) {
  const MutexLock lock(&mutex_);
  if (profile_) steps_.resize(profile_->pieces().size());
}

std::size_t Tally::PieceOf(Moment intended) const {
  return profile_->PieceAt(SecondsOf(intended - from_));
}

Tally::Step* Tally::StepOf(Moment intended) {
  return profile_ ? &steps_[PieceOf(intended)] : nullptr;
}

bool Tally::Counts(Moment intended) const {
  return intended >= from_ && (!profile_ || profile_->pieces()[PieceOf(intended)].counts);
}

double Tally::At(Moment moment) const {
  const double seconds = SecondsOf(moment - from_);
  return profile_ ? profile_->Counted(seconds) : seconds;
}

void Tally::CountSent(const Sent& message) {
  if (!Counts(message.intended)) return;
  const MutexLock lock(&mutex_);
  OperationResults& operation = operations_[message.operation];
  ++operation.sent;
  const double at = At(message.intended);
  intervals_.Offered(message.operation, at);
  if (message.sent - message.intended > kLateAfter) {
    ++operation.late;
    intervals_.Late(message.operation, at);
  }
  if (Step* const step = StepOf(message.intended)) ++step->offered;
}

void Tally::CountUnsent(Operation operation, Moment intended) {
  if (!Counts(intended)) return;
  const MutexLock lock(&mutex_);
  ++operations_[operation].unsent;
  intervals_.Offered(operation, At(intended));
  intervals_.Unsent(operation, At(intended));
  if (Step* const step = StepOf(intended)) ++step->offered;
}

void Tally::CountAnswered(const Sent& message, Moment answered, std::optional<ServerTimes> times) {
  const double response = MicrosOf(answered - message.intended);
  const MutexLock lock(&mutex_);
  ++glance_.answered;
  glance_.response.Record(response);
  if (!Counts(message.intended)) return;
  OperationResults& operation = operations_[message.operation];
  ++operation.answered;
  operation.response.Record(response);
  operation.service.Record(MicrosOf(answered - message.sent));
  if (times) {
    operation.queue.Record(times->queue_micros);
    operation.solve.Record(times->solve_micros);
  }
  intervals_.Answered(message.operation, At(answered), response);
  if (Step* const step = StepOf(message.intended)) {
    ++step->answered;
    step->response.Record(response);
  }
}

void Tally::CountFailed(const Sent& message, Moment now) {
  const MutexLock lock(&mutex_);
  ++glance_.failed;
  if (!Counts(message.intended)) return;
  ++operations_[message.operation].failed;
  intervals_.Failed(message.operation, At(now));
}

void Tally::CountReplaced(const Sent& message) {
  if (!Counts(message.intended)) return;
  const MutexLock lock(&mutex_);
  ++operations_[message.operation].replaced;
  intervals_.Replaced(message.operation, At(message.intended));
  if (Step* const step = StepOf(message.intended)) ++step->replaced;
}

void Tally::CountVerified(Operation operation, bool right) {
  const MutexLock lock(&mutex_);
  OperationResults& done = operations_[operation];
  ++done.verified;
  if (!right) ++done.wrong;
}

void Tally::Note(const std::string& code, const std::string& reason, const std::string& sentence) {
  LoadError& error = errors_[{code, reason}];
  if (error.count++ > 0) return;
  error.code = code;
  error.reason = reason;
  error.first = sentence;
}

void Tally::CountError(const Fault& fault) {
  const std::string reason = ReasonOf(fault);
  std::string sentence = Describe(fault);
  if (sentence.starts_with(reason + ": ")) sentence.erase(0, reason.size() + 2);
  const MutexLock lock(&mutex_);
  Note(Printable(DetailOf(fault, kGrpcCodeDetail)), reason, sentence);
}

void Tally::CountBadReply(const std::string& sentence) {
  const MutexLock lock(&mutex_);
  Note("", "BAD_REPLY", Printable(sentence));
}

void Tally::CountRefused(double micros) {
  const MutexLock lock(&mutex_);
  refused_.Record(micros);
}

void Tally::CountResumed() {
  const MutexLock lock(&mutex_);
  ++resumed_;
}

void Tally::CountLost(std::uint64_t frames) {
  const MutexLock lock(&mutex_);
  lost_ += frames;
}

void Tally::CountEcho(Moment intended, double micros) {
  if (!Counts(intended)) return;
  const MutexLock lock(&mutex_);
  echo_.Record(micros);
}

Glance Tally::TakeGlance() {
  const MutexLock lock(&mutex_);
  return std::exchange(glance_, {});
}

void Tally::AddTo(LoadResults& results) const {
  const MutexLock lock(&mutex_);
  for (std::size_t i = 0; i < kOperations; ++i) {
    const auto operation = static_cast<Operation>(i);
    results.operations[operation].Add(operations_[operation]);
  }
  results.echo.Merge(echo_);
}

void Tally::AddTroublesTo(LoadResults& results) const {
  const MutexLock lock(&mutex_);
  for (const auto& entry : errors_) {
    const LoadError& error = entry.second;
    const auto same = std::find_if(
        results.errors.begin(), results.errors.end(),
        [&](const LoadError& one) { return one.code == error.code && one.reason == error.reason; });
    if (same == results.errors.end()) {
      results.errors.push_back(error);
    } else {
      same->count += error.count;
    }
  }
  results.refused.Merge(refused_);
  results.resumptions += resumed_;
  results.frames_lost += lost_;
}

void Tally::AddTimes(const std::vector<std::unique_ptr<Tally>>& tallies, Moment end,
                     LoadResults& results) {
  if (tallies.empty()) return;
  const Tally& first = *tallies.front();
  IntervalLog intervals;
  std::vector<Step> steps(first.profile_ ? first.profile_->pieces().size() : 0);
  for (const auto& tally : tallies) {
    const MutexLock lock(&tally->mutex_);
    intervals.Merge(tally->intervals_);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      steps[i].offered += tally->steps_[i].offered;
      steps[i].answered += tally->steps_[i].answered;
      steps[i].replaced += tally->steps_[i].replaced;
      steps[i].response.Merge(tally->steps_[i].response);
    }
  }
  results.intervals = intervals.Intervals(first.At(end));
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const RateProfile::Piece& piece = first.profile_->pieces()[i];
    if (!piece.counts) continue;
    LoadStep& step = results.steps.emplace_back();
    step.rate = piece.mean();
    step.seconds = piece.seconds;
    step.answered = static_cast<double>(steps[i].answered) / piece.seconds;
    step.p50 = steps[i].response.Quantile(0.5);
    step.p99 = steps[i].response.Quantile(0.99);
    step.met = IsHeld(steps[i].offered, steps[i].answered, steps[i].replaced);
  }
}

}  // namespace arap::cli
