#include "client/cli/load/load_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

#include "client/cli/load/echo_load.h"
#include "client/cli/load/engine.h"
#include "client/cli/load/rates.h"
#include "client/cli/load/reports.h"
#include "client/cli/load/tally.h"
#include "client/cli/terminal.h"
#include "client/src/channel.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

constexpr double kSeconds = 10;
constexpr double kFirstRate = 100;
constexpr std::chrono::milliseconds kSearchPatience = std::chrono::minutes(1);
// With a number of messages and no time: as long as it takes.
constexpr double kAnyTime = 1e6;

// Streams need no descriptors, connections do.
void AllowDescriptors(std::size_t connections) {
  constexpr std::size_t kOthers = 256;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= connections + kOthers) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, connections + kOthers);
  (void)setrlimit(RLIMIT_NOFILE, &limit);  // what is missing then, the connection says
}

Result<std::vector<std::unique_ptr<LoadConnection>>> OpenConnections(
    const Connection& connection, std::size_t count, const std::vector<std::string>& tokens) {
  std::vector<std::unique_ptr<LoadConnection>> opened;
  for (std::size_t i = 0; i < count; ++i) {
    client::ConnectOptions options = connection.options();
    if (i % tokens.size() > 0) options.token = tokens[i % tokens.size()];
    TRY(auto channel, client::internal::Channel::Open(connection.address(), options));
    const auto until = std::chrono::system_clock::now() + std::chrono::seconds(10);
    if (!channel->grpc().WaitForConnected(until)) {
      return Fail(FaultKind::kDraining,
                  fmt::format("Connection {} of {} to {} does not stand after 10 s.", i + 1, count,
                              connection.address()));
    }
    opened.push_back(std::make_unique<LoadConnection>(std::move(channel)));
  }
  return opened;
}

Result<LoadScene> SceneOf(const LoadRequest& request) {
  if (!request.mesh_file.empty()) {
    return ReadLoadScene(request.mesh_file, request.handles, request.handles_file);
  }
  LoadScene scene = MakeLoadScene(request.vertices, request.handles);
  if (!request.handles_file.empty()) CHECK_OK(TakeHandles(request.handles_file, scene));
  return scene;
}

std::string Many(double count, const char* what) { return fmt::format("{:g} {}", count, what); }

std::string HowOf(const LoadRequest& request) {
  if (request.search) {
    return fmt::format("open loop, search for the highest rate with {}, to {:g} %",
                       request.search->text, 100 * request.resolution);
  }
  std::string how = "open loop, ";
  if (request.fps) {
    how += fmt::format("{:g} a second of each stream, {} on the way", *request.fps,
                       request.window.value_or(1));
  } else if (request.stream_rate) {
    how += Many(*request.stream_rate, "a second of each stream");
  } else if (request.rate) {
    how += Many(*request.rate, "a second");
  } else if (request.profile) {
    how += *request.profile;
  } else {
    return fmt::format("closed loop, {} on the way of each stream", request.window.value_or(1));
  }
  return how + (request.poisson ? ", Poisson" : ", evenly spaced");
}

// One run, with as many phases as it takes.
class LoadCourse {
 public:
  LoadCourse(const LoadRequest& request, LoadEngine& engine, std::stop_token stop)
      : request_(request),
        engine_(engine),
        stop_(std::move(stop)),
        line_(request.quiet),
        length_(request.seconds.value_or(request.count && !request.profile ? kAnyTime : kSeconds)) {
  }

  Result<LoadResults> Go() {
    if (request_.search) return Search();
    std::optional<RateProfile> profile;
    if (request_.profile) {
      TRY(profile, RateProfile::Parse(*request_.profile, length_));
    } else if (const auto rate = TotalRate()) {
      profile = RateProfile::Constant(*rate, length_);
    }
    const auto phase = MakePhase(profile);
    OpenSessions();
    if (phase->each_from_opening) {
      Start(*phase);
      engine_.OpenStreams(phase);
      began_ = Now();
    } else {
      engine_.OpenStreams(opening_);
      Start(*phase);
    }
    std::optional<StabilityRule> stable;
    if (request_.until_stable) stable.emplace(*request_.until_stable);
    LoadResults results = Send(phase, [&](bool counts, const Glance& glance) {
      return !(stable && counts &&
               stable->Add(static_cast<double>(glance.answered), glance.response.Quantile(0.5)));
    });
    AddTroubles(*opening_, results);
    AddTroubles(*phase, results);
    return results;
  }

 private:
  using Counts = std::function<bool(bool counts, const Glance& glance)>;

  std::optional<double> TotalRate() const {
    if (request_.fps) return request_.fps;  // each has the profile to itself
    if (request_.rate) return request_.rate;
    if (!request_.stream_rate) return std::nullopt;
    return *request_.stream_rate * static_cast<double>(request_.streams);
  }

  std::shared_ptr<LoadPhase> MakePhase(const std::optional<RateProfile>& profile) const {
    auto phase = std::make_shared<LoadPhase>();
    phase->streams = request_.streams;
    phase->each_from_opening = request_.fps.has_value();
    phase->poisson = request_.poisson;
    phase->most = request_.count;
    const bool bound = !profile || request_.fps;
    phase->window = request_.window.value_or(bound ? 1 : kMostOnTheirWay);
    if (profile) {
      phase->profile = std::make_shared<const RateProfile>(profile->WarmedUp(request_.warm_up));
    }
    if (request_.echo > 0) {
      phase->echo = std::make_shared<const RateProfile>(
          RateProfile::Constant(request_.echo, LengthOf(*phase)));
    }
    return phase;
  }

  // The phase begins now, or as soon as all streams can know of it.
  void Start(LoadPhase& phase) {
    phase.begin = Now();
    if (!phase.each_from_opening) {
      phase.begin += std::chrono::milliseconds(10) +
                     static_cast<Moment::rep>(request_.streams) * std::chrono::microseconds(10);
    }
    // A profile says itself what of it counts.
    const bool steps = request_.profile.has_value();
    const Moment from = phase.begin + FromSeconds(steps ? 0 : request_.warm_up);
    phase.end = phase.begin + FromSeconds(LengthOf(phase));
    began_ = from;
    phase.tallies = LoadEngine::MakeTallies(from, steps ? phase.profile : nullptr);
  }

  void OpenSessions() {
    opening_ = std::make_shared<LoadPhase>();
    opening_->streams = request_.streams;
    opening_->tallies = LoadEngine::MakeTallies(Now());
    engine_.OpenSessions(opening_->TallyOf(0));
  }

  // The warm-up of a phase in all, and how long it is with that.
  double WarmUpOf(const LoadPhase& phase) const {
    const bool steps = request_.profile && request_.warm_up > 0;
    const std::size_t times = steps ? phase.profile->pieces().size() / 2 : 1;
    return request_.warm_up * static_cast<double>(times);
  }
  double LengthOf(const LoadPhase& phase) const { return WarmUpOf(phase) + length_; }
  // Whether the second that ends so many seconds after the beginning counts.
  bool CountsBefore(const LoadPhase& phase, double seconds) const {
    if (!request_.profile) return seconds > request_.warm_up;
    return phase.profile->pieces()[phase.profile->PieceAt(seconds - 0.5)].counts;
  }

  // The numbers of a phase, without its troubles.
  LoadResults Send(const std::shared_ptr<LoadPhase>& phase, const Counts& goes_on) {
    const PhaseEnd end = engine_.Run(phase, [&](double seconds, const Glance& glance) {
      errors_ += glance.failed;
      const bool counts = CountsBefore(*phase, seconds);
      line_.Show(ProgressText({seconds, request_.count ? 0 : LengthOf(*phase), !counts,
                               static_cast<double>(glance.answered), glance.response.Quantile(0.5),
                               glance.response.Quantile(0.99), errors_}),
                 errors_ > 0 ? std::optional(Look::kBad) : std::nullopt);
      return goes_on(counts, glance);
    });
    LoadResults results;
    const double ran = std::max(SecondsOf(end.ended - began_), 0.0);
    results.seconds = request_.profile ? phase->profile->Counted(ran) : ran;
    results.warm_up_seconds = WarmUpOf(*phase);
    results.own_nanos_per_message = end.own_nanos_per_message;
    for (const auto& tally : phase->tallies) tally->AddTo(results);
    Tally::AddTimes(phase->tallies, end.ended, results);
    return results;
  }

  static void AddTroubles(const LoadPhase& phase, LoadResults& results) {
    for (const auto& tally : phase.tallies) tally->AddTroublesTo(results);
  }

  LoadResults Search() {
    OpenSessions();
    engine_.OpenStreams(opening_);
    RateSearch search(request_.rate.value_or(kFirstRate), request_.resolution);
    LoadResults best, troubles;
    std::vector<LoadStep> steps;
    AddTroubles(*opening_, troubles);
    while (search.next() && !stop_.stop_requested()) {
      const double rate = *search.next();
      const auto phase = MakePhase(RateProfile::Constant(rate, length_));
      Start(*phase);
      LoadResults trial = Send(phase, [](bool, const Glance&) { return true; });
      if (stop_.stop_requested()) break;  // half a trial says nothing
      LoadStep& step = steps.emplace_back(StepOf(rate, *phase, trial));
      search.Tried(step.met);
      AddTroubles(*phase, troubles);
      if (step.met || !search.found()) best = std::move(trial);
    }
    best.steps = std::move(steps);
    best.rate_found = search.found();
    best.errors = std::move(troubles.errors);
    best.refused = std::move(troubles.refused);
    best.resumptions = troubles.resumptions;
    best.frames_lost = troubles.frames_lost;
    return best;
  }

  LoadStep StepOf(double rate, const LoadPhase& phase, const LoadResults& trial) const {
    LoadResults judged = trial;
    AddTroubles(phase, judged);
    const OperationResults total = trial.Total();
    const bool held = IsHeld(total.sent + total.unsent, total.answered, total.replaced);
    const std::vector<Judgement> judgements = Judge(std::span(&*request_.search, 1), judged);
    LoadStep step;
    step.rate = rate;
    step.seconds = length_;
    step.answered = static_cast<double>(total.answered) / length_;
    step.p50 = total.response.Quantile(0.5);
    step.p99 = total.response.Quantile(0.99);
    step.met = held && judged.errors.empty() && judgements[0].met;
    return step;
  }

  const LoadRequest& request_;
  LoadEngine& engine_;
  const std::stop_token stop_;
  StatusLine line_;
  const double length_;
  std::uint64_t errors_ = 0;
  std::shared_ptr<LoadPhase> opening_;  // what opening ran into, unless streams send at once
  Moment began_{0};                     // what counts of the phase
};

}  // namespace

Result<LoadResults> RunLoad(const LoadRequest& request, std::stop_token stop) {
  TRY(const LoadScene scene, SceneOf(request));
  std::vector<std::string> tokens{""};  // that of the connection itself
  for (const std::string& path : request.more_token_files) {
    TRY(tokens.emplace_back(), ReadTokenFile(path));
  }
  std::vector<ServerFlags> servers{request.server};
  if (request.verify > 0) servers.emplace_back().spawn = true;
  TRY(const std::vector<Connection> opened, Connection::OpenAll(servers));
  const Connection& connection = opened.front();
  const std::size_t enough = (request.streams - 1) / kStreamsOfAConnection + 1;
  const std::size_t count = std::max(request.connections.value_or(enough), tokens.size());
  AllowDescriptors(count);
  TRY(auto connections, OpenConnections(connection, count, tokens));

  std::optional<TransportResults> transport;
  if (request.transport > 0) {
    EchoPlan plan{.streams = request.streams,
                  .window = request.window.value_or(1),
                  .seconds = request.transport};
    MeasureMessages(scene.handles.size(), scene.mesh.vertices.size(), request.encoding, plan);
    TRY(transport, RunEchoes(connections, plan, stop));
  }

  EngineOptions options;
  options.streams = request.streams;
  options.sessions = std::min(request.sessions.value_or(request.streams), request.streams);
  options.shape.deform = request.deform;
  options.shape.encoding = request.encoding;
  options.delivery = request.delivery;
  options.mix = request.mix;
  options.seed = request.seed;
  // What a rate that is too high has left behind is not to be in the way of the next one.
  if (request.search) options.patience = kSearchPatience;
  options.verify = request.verify;
  options.resume_within = std::chrono::milliseconds(
      std::llround(1000 * request.resume.value_or(request.server.spawn ? 0 : 10)));
  LoadEngine engine(options, scene, std::move(connections), tokens.size(), stop);
  if (request.verify > 0) CHECK_OK(engine.VerifyWith(opened.back().client()));
  TRY(LoadResults results, LoadCourse(request, engine, std::move(stop)).Go());
  engine.Close();
  results.how = HowOf(request);
  results.transport = std::move(transport);
  results.streams = request.streams;
  results.sessions = options.sessions;
  results.connections = count;
  results.vertices = scene.mesh.vertices.size();
  results.handles = scene.handles.size();
  return results;
}

}  // namespace arap::cli
