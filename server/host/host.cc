#include "server/host/host.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <google/protobuf/message.h>
#include <grpc/health/v1/health.pb.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/service_type.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "core/base/try.h"
#include "server/host/listen.h"
#include "server/host/process_metrics.h"

namespace arap::host {
namespace {

// A client may ask for a sign of life this often, also without a call. Clients that ping more often
// than a server allows are cut off, so this is generous.
constexpr int kMinPingIntervalMs = 1'000;
constexpr std::chrono::milliseconds kHealthPeriod = std::chrono::seconds(1);
constexpr std::size_t kTrimEvery = 10;  // sweeps

void Configure(const HostOptions& options, grpc::ServerBuilder& builder) {
  constexpr std::size_t kLargest = std::numeric_limits<int>::max();
  // Twice ours: a request just beyond the limit is refused by us, with all details.
  builder.SetMaxReceiveMessageSize(
      static_cast<int>(std::min(options.limits.max_message_bytes, kLargest / 2) * 2));
  // Answers are bounded by the size of the meshes.
  builder.SetMaxSendMessageSize(-1);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // Else the window of a stream grows while we do not read it, and with it what we hold for a
  // client that sends on and on. A message that has begun gets the window that it needs anyway.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinPingIntervalMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS,
                             static_cast<int>(options.keepalive.count()));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS,
                             static_cast<int>(options.keepalive_timeout.count()));
}

void LogRecovery(const store::Recovery& recovery) {
  spdlog::error("event=store_recovered saved={} lost={} complete={} damaged_database=\"{}\"",
                recovery.saved, recovery.lost, recovery.complete, recovery.kept_as);
}

// Both are switches of the whole process, read when a server is built: one server is built at a
// time.
std::unique_ptr<grpc::Server> Build(grpc::ServerBuilder& builder) {
  grpc::EnableDefaultHealthCheckService(true);
  return builder.BuildAndStart();
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
      services_(rpc::MakeServices(engine_, credentials_->identity())),
      listen_(options.listen) {
  // Jobs may take long.
  for (const runtime::WorkerPool* lane : {&engine_.interactive, &engine_.control}) {
    readiness_.WatchLane(lane->name(), [lane] { return lane->stats(); });
  }
  readiness_.WatchStore([this] { return engine_.stores.specs->Probe(); });
  WatchProcess(engine_.metrics);
  WatchEngine(engine_);
}

Host::~Host() { Stop(std::chrono::milliseconds::zero()); }

Status Host::Serve(const HostOptions& options) {
  const bool local = std::all_of(listen_.begin(), listen_.end(), IsLocal);
  if (options.reflection.value_or(local)) {
    // What is not linked in, reflection cannot show: nothing else here names these messages.
    google::protobuf::LinkMessageReflection<grpc::health::v1::HealthCheckRequest>();
    static std::once_flag once;
    std::call_once(once, grpc::reflection::InitProtoReflectionServerBuilderPlugin);
  }
  grpc::ServerBuilder builder;
  Configure(options, builder);
  std::vector<int> ports(listen_.size(), 0);
  for (std::size_t i = 0; i < listen_.size(); ++i) {
    CHECK_OK(PrepareAddress(listen_[i]));
    builder.AddListeningPort(listen_[i], credentials_->CredentialsFor(listen_[i]), &ports[i]);
  }
  for (const rpc::NamedService& service : services_) {
    builder.RegisterService(service.service.get());
  }
  server_ = Build(builder);
  if (!server_) return Fail(CannotListen(ports));
  if (auto* health = server_->GetHealthCheckService()) {
    for (const rpc::NamedService& service : services_) {
      health->SetServingStatus(service.name, true);
    }
  }
  for (std::size_t i = 0; i < listen_.size(); ++i) {
    addresses_.push_back(BoundAddress(listen_[i], ports[i]));
  }
  if (!options.admin.empty()) {
    TRY(admin_, AdminHttp::Start(options.admin, {[this] { return readiness_.Check(); },
                                                 [this] { return engine_.metrics.Text(); }}));
  }
  health_ticker_ = std::make_unique<runtime::Ticker>(kHealthPeriod, [this] { RefreshHealth(); });
  sweeping_ = options.sweep.count() > 0;
  sweep_ticker_ = std::make_unique<runtime::Ticker>(options.sweep, [this] { Sweep(); });
  return {};
}

void Host::Sweep() {
  // What a flood or an eviction has freed goes back to the system: by itself the allocator keeps
  // the most that each of its arenas ever held.
  if (++sweeps_ % kTrimEvery == 0) malloc_trim(0);
  const Status swept = engine_.Sweep();
  if (swept && sweep_failed_) spdlog::info("event=sweeping_again");
  if (!swept && !sweep_failed_) {
    spdlog::warn("event=sweep_failed reason={} message=\"{}\"", FaultName(swept.error().kind),
                 swept.error().message);
  }
  sweep_failed_ = !swept;
}

void Host::RefreshHealth() {
  readiness_.Probe();
  const Verdict verdict = readiness_.Check();
  const MutexLock lock(&health_mutex_);
  if (verdict.state != said_) {
    spdlog::log(verdict.ready() ? spdlog::level::info : spdlog::level::warn,
                "event=readiness state={} why=\"{}\"", StateName(verdict.state), verdict.why);
  }
  said_ = verdict.state;
  SayServing(verdict.ready());
}

void Host::AnnounceStop() {
  readiness_.AnnounceStop();
  const MutexLock lock(&health_mutex_);
  said_ = Verdict::State::kDraining;
  SayServing(false);
}

void Host::Stop(std::chrono::milliseconds grace) {
  AnnounceStop();
  for (runtime::Ticker* ticker : {health_ticker_.get(), sweep_ticker_.get()}) {
    if (ticker != nullptr) ticker->Stop();
  }
  if (server_) {
    engine_.streams.Drain();
    server_->Shutdown(std::chrono::system_clock::now() + grace);
    server_->Wait();
    server_.reset();
    for (const std::string& address : listen_) {
      if (const std::string path = UnixPath(address); !path.empty()) unlink(path.c_str());
    }
  }
  // After the calls: their last jobs finish them.
  for (runtime::WorkerPool* lane : {&engine_.control, &engine_.interactive, &engine_.jobs}) {
    lane->Stop();
  }
  // Lives that have become longer since the last sweep.
  if (std::exchange(sweeping_, false)) Sweep();
  admin_.reset();
}

void Host::SayServing(bool serving) {
  auto* health = server_ ? server_->GetHealthCheckService() : nullptr;
  if (health != nullptr) health->SetServingStatus(serving);
}

Fault Host::CannotListen(const std::vector<int>& ports) const {
  // The first port that was not bound; those after it were not tried.
  std::size_t failed = 0;
  while (failed + 1 < ports.size() && ports[failed] != 0) ++failed;
  const std::string address = listen_.empty() ? "(no address)" : listen_[failed];
  return Fault(FaultKind::kAlreadyExists,
               fmt::format("Cannot listen on {}: it is in use or not an address of this machine.",
                           address))
      .Field("listen")
      .Detail("address", address);
}

}  // namespace arap::host
