#include "client/cli/load/engine.h"

#include <algorithm>
#include <stop_token>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

#include "client/cli/report.h"
#include "client/src/answers.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

constexpr std::size_t kTallies = 4;
constexpr std::size_t kPacers = 2;
constexpr std::size_t kOpeningAtOnce = 256;
constexpr Moment kSecond = std::chrono::seconds(1);
constexpr Moment kLastWords = std::chrono::seconds(5);

double ProcessorNanos() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto nanos = [](const timeval& time) {
    return 1e9 * static_cast<double>(time.tv_sec) + 1e3 * static_cast<double>(time.tv_usec);
  };
  return nanos(usage.ru_utime) + nanos(usage.ru_stime);
}

}  // namespace

LoadEngine::LoadEngine(const EngineOptions& options, const LoadScene& scene,
                       std::vector<std::unique_ptr<LoadConnection>> connections, std::size_t tokens,
                       std::stop_token stop)
    : options_(options),
      scene_(scene),
      connections_(std::move(connections)),
      tokens_(tokens),
      stop_(std::move(stop)),
      side_calls_(scene, options.seed, gate_),
      kind_{.scene = scene,
            .shape = options.shape,
            .delivery = options.delivery,
            .mix = options.mix,
            .seed = options.seed,
            .verify = options.verify,
            .resume_within = options.resume_within,
            .silence = options.silence,
            .side_calls = &side_calls_,
            .gate = &gate_,
            .bell = &bell_} {}

LoadEngine::~LoadEngine() { Close(); }

Status LoadEngine::VerifyWith(const client::Client& reference) {
  TRY(verifier_, Verifier::Open(reference, scene_));
  kind_.verifier = verifier_.get();
  side_calls_.VerifyWith(*verifier_);
  return {};
}

LoadConnection& LoadEngine::ConnectionOf(std::size_t session, std::size_t turn) const {
  const std::size_t token = session % tokens_;
  const std::size_t own = (connections_.size() - token + tokens_ - 1) / tokens_;
  return *connections_[token + tokens_ * ((session / tokens_ + turn) % own)];
}

void LoadEngine::OpenSessions(Tally& tally) {
  client::CallOptions call;
  call.stop = stop_;
  sessions_ = OpenLoadSessions(
      options_.sessions, [this](std::size_t i) -> LoadConnection& { return ConnectionOf(i, 0); },
      scene_, call, [&](const Fault& fault) { tally.CountError(fault); });
}

void LoadEngine::OpenStreams(const std::shared_ptr<LoadPhase>& phase) {
  pacer_ = std::make_unique<Pacer>(kPacers, [this](std::size_t i) { streams_[i]->Wake(); });
  kind_.pacer = pacer_.get();
  streams_.reserve(options_.streams);
  for (std::size_t i = 0; i < options_.streams; ++i) {
    const std::size_t session = i % sessions_.size();
    streams_.push_back(std::make_unique<LiveStream>(kind_, i, sessions_[session],
                                                    ConnectionOf(session, i / sessions_.size())));
  }
  const std::stop_callback cancel(stop_, [this] {
    for (const auto& stream : streams_) stream->Cancel();
  });
  const auto opening = std::make_shared<Gate>();
  const auto await = [&](std::size_t fewer) {
    while (!opening->AwaitFewer(fewer, std::chrono::steady_clock::now() + kSecond)) {
      // Streams give silent servers up.
      for (const auto& stream : streams_)
        stop_.stop_requested() ? stream->Cancel() : stream->Look();
    }
  };
  for (std::size_t i = 0; i < streams_.size() && !stop_.stop_requested(); ++i) {
    await(kOpeningAtOnce);
    opening->Enter();
    if (!streams_[i]->Open(phase, [opening] { opening->Leave(); })) opening->Leave();
  }
  await(1);
}

PhaseEnd LoadEngine::Run(const std::shared_ptr<LoadPhase>& phase, const OnSecond& on_second) {
  const double processor = ProcessorNanos();
  const std::uint64_t messages = Messages();
  seconds_ = 0;
  if (!phase->each_from_opening) {
    for (const auto& stream : streams_) stream->Begin(phase);
  }
  // Streams that begin by themselves end by themselves.
  const Moment until = phase->each_from_opening ? kNever : phase->end + LiveStream::kTail;
  Watch(*phase, until, on_second);
  for (const auto& stream : streams_) stream->StopSending();
  const Moment patience = Now() + options_.patience;
  if (!stop_.stop_requested()) Watch(*phase, patience, [](double, const Glance&) { return true; });
  std::size_t given_up = 0;
  for (const auto& stream : streams_) given_up += stream->GiveUpWaiting();
  PhaseEnd end{Now(), 0};
  if (given_up > 0 && !stop_.stop_requested()) {
    const Fault fault(FaultKind::kDeadlineExceeded,
                      fmt::format("{} had no answer {:g} s after the last one was sent.",
                                  Numbered(given_up, "message"),
                                  std::chrono::duration<double>(options_.patience).count()));
    phase->TallyOf(0).CountError(fault);
  }
  const std::uint64_t sent = Messages() - messages;
  if (sent > 0) {
    end.own_nanos_per_message = (ProcessorNanos() - processor) / static_cast<double>(sent);
  }
  if (verifier_) verifier_->AwaitAnswers();
  return end;
}

bool LoadEngine::Watch(const LoadPhase& phase, Moment until, const OnSecond& on_second) {
  const std::stop_callback ring(stop_, [this] { bell_.Ring(); });
  std::size_t done = 0;  // so many streams, the first ones, are; they stay it
  for (;;) {
    while (done < streams_.size() && streams_[done]->is_done()) ++done;
    if (done == streams_.size()) return true;
    if (stop_.stop_requested()) return false;
    const Moment now = Now();
    if (now >= until) return true;
    if (now - looked_ >= kSecond) {
      looked_ = now;
      for (const auto& stream : streams_) stream->Look();
    }
    const auto next_second = [&] {
      return phase.begin + static_cast<Moment::rep>(seconds_ + 1) * kSecond;
    };
    if (now >= next_second()) {
      ++seconds_;
      Glance glance;
      for (const auto& tally : phase.tallies) {
        const Glance part = tally->TakeGlance();
        glance.answered += part.answered;
        glance.failed += part.failed;
        glance.response.Merge(part.response);
      }
      if (!on_second(static_cast<double>(seconds_), glance)) return false;
    }
    const Moment next = std::min({until, looked_ + kSecond, next_second()});
    bell_.AwaitUntil(std::chrono::steady_clock::time_point(next));
  }
}

std::uint64_t LoadEngine::Messages() const {
  std::uint64_t messages = 0;
  for (const auto& stream : streams_) messages += stream->messages();
  return messages;
}

void LoadEngine::Close() {
  const std::stop_callback ring(stop_, [this] { bell_.Ring(); });
  for (const auto& stream : streams_) stream->Close();
  const Moment until = Now() + kLastWords;
  for (std::size_t over = 0; Now() < until && !stop_.stop_requested();) {
    while (over < streams_.size() && streams_[over]->is_over()) ++over;
    if (over == streams_.size()) break;
    bell_.AwaitUntil(std::chrono::steady_clock::time_point(until));
  }
  pacer_.reset();
  for (const auto& stream : streams_) stream->Cancel();
  side_calls_.CancelAll();
  gate_.AwaitEmpty();
  streams_.clear();
  DeleteLoadSessions(std::exchange(sessions_, {}), {});
}

std::vector<std::unique_ptr<Tally>> LoadEngine::MakeTallies(
    Moment from, const std::shared_ptr<const RateProfile>& steps) {
  std::vector<std::unique_ptr<Tally>> tallies;
  for (std::size_t i = 0; i < kTallies; ++i)
    tallies.push_back(std::make_unique<Tally>(from, steps));
  return tallies;
}

}  // namespace arap::cli
