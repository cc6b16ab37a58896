#include "server/host/host.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include <google/protobuf/message.h>
#include <grpc/health/v1/health.pb.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/service_type.h>
#include <grpcpp/resource_quota.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "core/base/try.h"
#include "server/host/listen.h"
#include "server/rpc/unary.h"
#include "server/runtime/metrics.h"

namespace arap::host {
namespace {

// A client may ask for a sign of life this often, also without a call. Clients that ping more often
// than a server allows are cut off, so this is generous.
constexpr int kMinPingIntervalMs = 1'000;
constexpr std::chrono::milliseconds kHealthPeriod = std::chrono::seconds(1);
constexpr std::chrono::milliseconds kDialPatience = std::chrono::seconds(2);
// Memory that is held and not accounted for goes back to the system when it is so much, so often;
// and at once when the budget is nearly used up, if it is so much more than after the last time.
// Meanwhile whoever needs memory waits.
constexpr double kLoose = 48e6;
constexpr std::size_t kTrimEvery = 10;  // sweeps
constexpr double kNearly = 0.7;         // of the budget
constexpr double kMoreLoose = 32e6;
// What is in use that nobody accounts for, before connections with many calls are cut.
constexpr std::size_t kUnaccounted = 64'000'000;

// Descriptors for everything but connections: store, logs, libraries, files of the moment.
constexpr std::size_t kReserve = 256;
// What gRPC may hold beside requests that come in; when it is used up gRPC ends calls at random, so
// that other bounds come first.
constexpr std::size_t kGrpcBytes = std::size_t{1} << 30u;
constexpr int kReflectionThreads = 16;
// All streams that an owner may have, and calls beside them. What a stranger may begin before we see
// the first of it.
constexpr int kMostCallsPerConnection = 320;
constexpr int kMostHeaderBytes = 16 * 1'024;
constexpr int kHandshakeMs = 10'000;
// Streams are asked to move at most_age and have so long before their connection is closed.
constexpr std::chrono::milliseconds kMoving = std::chrono::seconds(30);

// As many as there are descriptors for, and no more of half requests than a quarter of the memory, if
// two of the largest fit into that.
rpc::ConnectionBounds Bounded(rpc::ConnectionBounds bounds, const Limits& limits) {
  bounds.receiving_bytes = std::min(bounds.receiving_bytes,
                                    std::max(limits.max_bytes / 4, 2 * limits.max_message_bytes));
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  const std::size_t all = files.rlim_cur;
  bounds.most = std::min(bounds.most, all > 2 * kReserve ? all - kReserve : all / 2);
  bounds.most_per_address =
      std::min(bounds.most_per_address, std::max<std::size_t>(bounds.most, 1));
  return bounds;
}

void Configure(const HostOptions& options, grpc::ServerBuilder& builder) {
  constexpr std::size_t kLargest = std::numeric_limits<int>::max();
  // Twice ours: a request just beyond the limit is refused by us, with all details.
  builder.SetMaxReceiveMessageSize(
      static_cast<int>(std::min(options.limits.max_message_bytes, kLargest / 2) * 2));
  // Answers are bounded by the size of the meshes.
  builder.SetMaxSendMessageSize(-1);
  const auto set = [&builder](const char* name, std::chrono::milliseconds time) {
    builder.AddChannelArgument(name, static_cast<int>(time.count()));
  };
  // gRPC inflates a message whole before it looks at its size: compressed calls are refused with
  // UNIMPLEMENTED, and nothing is inflated.
  builder.AddChannelArgument(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET,
                             1 << GRPC_COMPRESS_NONE);
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  // Else the window of a stream grows while we do not read it, and with it what we hold for a
  // client that sends on and on. A message that has begun gets the window that it needs anyway.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMostCallsPerConnection);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, kMostHeaderBytes);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinPingIntervalMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  set(GRPC_ARG_KEEPALIVE_TIME_MS, options.keepalive);
  set(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, options.keepalive_timeout);
  if (const auto age = options.connections.most_age; age.count() > 0) {
    // gRPC adds or takes up to a tenth, so that not all come back at once. New calls go to a new
    // connection from then on; streams are asked by us.
    set(GRPC_ARG_MAX_CONNECTION_AGE_MS, age);
    set(GRPC_ARG_MAX_CONNECTION_AGE_GRACE_MS, age / 5 + kMoving);
  }
  grpc::ResourceQuota quota("arapd");
  quota.Resize(2 * options.connections.receiving_bytes + kGrpcBytes);
  quota.SetMaxThreads(kReflectionThreads);
  builder.SetResourceQuota(quota);
}

void LogRecovery(const store::Recovery& recovery) {
  spdlog::error("event=store_recovered saved={} lost={} complete={} damaged_database=\"{}\"",
                recovery.saved, recovery.lost, recovery.complete, recovery.kept_as);
}

}  // namespace

Result<std::unique_ptr<Host>> Host::Start(HostOptions options) {
  std::shared_ptr<const runtime::Clock> clock = options.clock;
  if (!clock) clock = std::make_shared<runtime::SystemClock>();
  TRY(auto credentials,
      Credentials::Open(options.credentials, options.listen, options.limits.owner, clock));
  options.store.on_recovery = LogRecovery;
  TRY(auto stores, store::OpenStores(options.store));
  if (stores.recovery) LogRecovery(*stores.recovery);
  std::unique_ptr<Host> host(
      new Host(options, std::move(clock), std::move(credentials), std::move(stores)));
  CHECK_OK(host->Serve(options));
  return host;
}

Host::Host(const HostOptions& options, std::shared_ptr<const runtime::Clock> clock,
           std::unique_ptr<Credentials> credentials, store::Stores stores)
    : clock_(std::move(clock)),
      credentials_(std::move(credentials)),
      engine_(options.limits, options.lanes, *clock_, std::move(stores)),
      readiness_(options.stuck_after, *clock_),
      connections_(Bounded(options.connections, options.limits), *clock_),
      identity_(credentials_->identity()),
      services_(rpc::MakeServices(engine_, identity_, options.echo)),
      health_(ServiceNames(), connections_),
      unknown_methods_(rpc::MakeUnknownMethods(connections_)),
      on_deaf_(options.on_deaf) {
  identity_.connections = &connections_;
  connections_.OnReceiving([this](std::size_t bytes) {
    half_requests_.Release();
    half_requests_ = engine_.derived.Hold({}, bytes);
  });
  connections_.OnPressure([this] { return UnderPressure(); });
  services_.push_back(health_.MakeService({engine_, identity_}));
  // Jobs may take long.
  for (const runtime::WorkerPool* lane : {&engine_.interactive, &engine_.control}) {
    readiness_.WatchLane(lane->name(), [lane] { return lane->stats(); });
  }
  readiness_.WatchStore([this] { return engine_.stores.specs->Probe(); },
                        [this] { return engine_.keeper.weaknesses(); });
  runtime::WatchProcess(engine_.metrics);
  const auto watch = [this](const runtime::MetricInfo& info, runtime::Metrics::Kind kind,
                            std::function<double()> read) {
    engine_.metrics.Watch(info, kind, {}, std::move(read));
  };
  watch(runtime::metric::kConnections, runtime::Metrics::Kind::kGauge,
        [this] { return static_cast<double>(connections_.count()); });
  watch(runtime::metric::kConnectionsCut, runtime::Metrics::Kind::kCounter,
        [this] { return static_cast<double>(connections_.cut()); });
  for (const char* quota :
       {"max_connections", "max_connections_per_address", "descriptors", "address_on_probation"}) {
    engine_.metrics.ServeQuota(quota);
  }
}

Host::~Host() { Stop(std::chrono::milliseconds::zero()); }

std::vector<std::string> Host::ServiceNames() const {
  std::vector<std::string> names;
  for (const rpc::NamedService& service : services_) names.push_back(service.name);
  return names;
}

Status Host::Serve(const HostOptions& options) {
  const bool local = std::all_of(options.listen.begin(), options.listen.end(), IsLocal);
  if (options.reflection.value_or(local)) {
    // What is not linked in, reflection cannot show: nothing else here names these messages.
    google::protobuf::LinkMessageReflection<grpc::health::v1::HealthCheckRequest>();
    static std::once_flag once;
    std::call_once(once, grpc::reflection::InitProtoReflectionServerBuilderPlugin);
  }
  grpc::ServerBuilder builder;
  Configure(options, builder);
  using grpc::experimental::ExternalConnectionAcceptor;
  std::vector<Acceptor::Entrance> entrances;
  for (const std::string& address : options.listen) {
    TRY(auto listening, Listening::Open(address, kForCalls, options.socket_mode));
    addresses_.push_back(listening.address());
    const std::shared_ptr<ExternalConnectionAcceptor> grpcs =
        builder.experimental().AddExternalConnectionAcceptor(
            grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD,
            credentials_->CredentialsFor(address));
    entrances.push_back({std::move(listening), [grpcs](int descriptor) {
                           ExternalConnectionAcceptor::NewConnectionParameters connection;
                           connection.fd = descriptor;
                           grpcs->HandleNewConnection(&connection);
                         }});
  }
  for (const rpc::NamedService& service : services_) {
    builder.RegisterService(service.service.get());
  }
  builder.RegisterCallbackGenericService(unknown_methods_.get());
  server_ = builder.BuildAndStart();
  if (!server_) return Fail(FaultKind::kInternal, "gRPC does not start.");
  if (!options.admin.empty()) {
    TRY(admin_, AdminHttp::Start(options.admin, {[this] { return readiness_.Check(); },
                                                 [this] { return engine_.metrics.Text(); }}));
  }
  acceptor_ = std::make_unique<Acceptor>(std::move(entrances), connections_, engine_.metrics);
  health_ticker_ = std::make_unique<runtime::Ticker>(kHealthPeriod, [this] { RefreshHealth(); });
  dial_ticker_ = std::make_unique<runtime::Ticker>(kHealthPeriod, [this] { Dial(); });
  sweeping_ = options.sweep.count() > 0;
  sweep_ticker_ = std::make_unique<runtime::Ticker>(options.sweep, [this] { Sweep(); });
  return {};
}

void Host::Dial() {
  const Status dialled = acceptor_->Dial(kDialPatience);
  readiness_.TellDialled(dialled);
  if (dialled) return;
  spdlog::warn("event=not_let_in message=\"{}\"", dialled.error().message);
  if (!readiness_.IsDeaf()) return;
  if (const auto on_deaf = std::exchange(on_deaf_, nullptr)) on_deaf();
}

void Host::Sweep() {
  TrimMemory();
  const Status swept = engine_.Sweep();
  if (swept && sweep_failed_) spdlog::info("event=sweeping_again");
  if (!swept && !sweep_failed_) {
    spdlog::warn("event=sweep_failed reason={} message=\"{}\"", FaultName(swept.error().kind),
                 swept.error().message);
  }
  sweep_failed_ = !swept;
}

bool Host::UnderPressure() const {
  const struct mallinfo2 memory = mallinfo2();
  return memory.uordblks + memory.hblkhd > engine_.derived.bytes() + kUnaccounted;
}

void Host::TrimMemory() {
  const double resident = runtime::ResidentBytes();
  ++sweeps_;
  if (resident <= static_cast<double>(engine_.derived.bytes()) + kLoose) return;
  const bool urgent = resident > kNearly * static_cast<double>(engine_.limits.max_bytes) &&
                      resident > trimmed_to_ + kMoreLoose;
  if (sweeps_ % kTrimEvery != 0 && !urgent) return;
  malloc_trim(0);
  trimmed_to_ = runtime::ResidentBytes();
}

void Host::LogWeaknesses() {
  std::set<std::string> now;
  for (const store::Weakness& weakness : engine_.keeper.weaknesses()) {
    now.insert(weakness.reason);
    if (weak_.contains(weakness.reason)) continue;
    spdlog::log(weakness.grave ? spdlog::level::err : spdlog::level::warn,
                "event=store_weakness reason={} message=\"{}\"", weakness.reason,
                weakness.sentence);
  }
  for (const std::string& reason : weak_) {
    if (!now.contains(reason)) spdlog::info("event=store_weakness_gone reason={}", reason);
  }
  weak_ = std::move(now);
}

void Host::RefreshHealth() {
  readiness_.Probe();
  const Verdict verdict = readiness_.Check();
  const MutexLock lock(&health_mutex_);
  LogWeaknesses();
  if (verdict.state != said_) {
    spdlog::log(verdict.ready() ? spdlog::level::info : spdlog::level::warn,
                "event=readiness state={} why=\"{}\"", StateName(verdict.state), verdict.why);
  }
  said_ = verdict.state;
  health_.Serving(verdict.ready());
}

void Host::AnnounceStop() {
  readiness_.AnnounceStop();
  const MutexLock lock(&health_mutex_);
  said_ = Verdict::State::kDraining;
  health_.Serving(false);
}

void Host::Stop(std::chrono::milliseconds grace) {
  AnnounceStop();
  for (runtime::Ticker* ticker : {health_ticker_.get(), dial_ticker_.get(), sweep_ticker_.get()}) {
    if (ticker != nullptr) ticker->Stop();
  }
  // Before gRPC stops: it takes no connections then.
  acceptor_.reset();
  if (server_) {
    engine_.streams.Drain();
    engine_.flatten_jobs.Drain();
    health_.End();
    server_->Shutdown(std::chrono::system_clock::now() + grace);
    server_->Wait();
    server_.reset();
  }
  // After the calls: their last jobs finish them.
  for (runtime::WorkerPool* lane : {&engine_.control, &engine_.interactive, &engine_.jobs}) {
    lane->Stop();
  }
  // Lives that have become longer since the last sweep.
  if (std::exchange(sweeping_, false)) Sweep();
  admin_.reset();
}

}  // namespace arap::host
