#include "server/rpc/health.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/try.h"
#include "proto/convert/status.h"
#include "server/budget/faults.h"
#include "server/rpc/unary.h"

namespace arap::rpc {
namespace {

using Request = grpc::health::v1::HealthCheckRequest;
using Response = grpc::health::v1::HealthCheckResponse;

constexpr std::size_t kMostWatchers = 256;

}  // namespace

// One call: Check answers once, Watch whenever the state changes.
class Health::Reactor final : public grpc::ServerBidiReactor<Request, Response>,
                              public std::enable_shared_from_this<Reactor> {
 public:
  Reactor(Health& health, bool watches) : health_(health), watches_(watches) {}

  void Start(const std::string& peer) {
    self_ = shared_from_this();
    counted_ = health_.connections_.Begin(peer, false);
    auto receiving =
        health_.connections_.Receive(peer, [weak = weak_from_this()](const Fault& late) {
          if (const auto self = weak.lock()) self->End(late);
        });
    const Status added = receiving && watches_ ? health_.Add(self_) : Status();
    const MutexLock lock(&mutex_);
    if (!receiving) return FinishWith(Fail(std::move(receiving.error())));
    if (!added) return FinishWith(added);
    receiving_ = *std::move(receiving);
    StartRead(&request_);
  }

  void End(const Fault& reason) {
    const MutexLock lock(&mutex_);
    FinishWith(Fail(reason));
  }

  // Writes the state if it is another than what was written last.
  void Tell() {
    const MutexLock lock(&mutex_);
    if (!read_ || writing_ || finished_) return;
    const State state = health_.StateOf(request_.service());
    if (told_ == state) return;
    told_ = state;
    response_.set_status(state);
    writing_ = true;
    StartWrite(&response_);
  }

  void OnReadDone(bool ok) override {
    {
      const MutexLock lock(&mutex_);
      receiving_.Received(ok ? request_.ByteSizeLong() : 0);
      if (!ok) return FinishWith(Fail(FaultKind::kCancelled, "The call ended without a request."));
      read_ = true;
      if (!watches_ && !finished_) {
        const State state = health_.StateOf(request_.service());
        if (state == Response::SERVICE_UNKNOWN) {
          return FinishWith(Fail(app::NotFound("service", "of that name")));
        }
        finished_ = true;
        response_.set_status(state);
        return StartWriteAndFinish(&response_, grpc::WriteOptions(), grpc::Status::OK);
      }
    }
    Tell();
  }

  void OnWriteDone(bool ok) override {
    {
      const MutexLock lock(&mutex_);
      writing_ = false;
      if (!ok) return FinishWith(Fail(FaultKind::kCancelled, "The caller has gone."));
      if (ending_) return FinishWith(*ending_);
    }
    Tell();
  }

  void OnCancel() override { End({FaultKind::kCancelled, "The caller has cancelled."}); }

  void OnDone() override {
    health_.Remove(this);
    const auto self = std::move(self_);
    // Whoever called Finish is in here until it has let go.
    const MutexLock lock(&mutex_);
  }

 private:
  void FinishWith(const Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (finished_) return;
    if (writing_) {
      ending_ = status;
      return;
    }
    finished_ = true;
    Finish(convert::ToGrpcStatus(status.error()));
  }

  Health& health_;
  const bool watches_;
  std::shared_ptr<Reactor> self_;  // from Start until OnDone
  std::shared_ptr<const void> counted_;
  Mutex mutex_;
  Connections::Entry receiving_ ABSL_GUARDED_BY(mutex_);
  Request request_;    // gRPC's until read_
  Response response_;  // gRPC's while writing_
  bool read_ ABSL_GUARDED_BY(mutex_) = false;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<Status> ending_ ABSL_GUARDED_BY(mutex_);
  std::optional<State> told_ ABSL_GUARDED_BY(mutex_);
};

Health::Health(const std::vector<std::string>& services, Connections& connections)
    : services_(services), connections_(connections) {}

Health::~Health() = default;

NamedService Health::MakeService(const Backend& backend) {
  auto service = std::make_unique<Methods>(backend, "grpc.health.v1.Health");
  for (const bool watches : {false, true}) {
    service->Stream<Request, Response>(
        watches ? "Watch" : "Check", [this, watches](Methods::Context* context) {
          const auto reactor = std::make_shared<Reactor>(*this, watches);
          reactor->Start(context->peer());
          return reactor.get();
        });
  }
  return Named(std::move(service));
}

void Health::Serving(bool serving) {
  std::vector<std::shared_ptr<Reactor>> watchers;
  {
    const MutexLock lock(&mutex_);
    if (serving_ == serving) return;
    serving_ = serving;
    watchers = Watchers();
  }
  for (const auto& watcher : watchers) watcher->Tell();
}

void Health::End() {
  std::vector<std::shared_ptr<Reactor>> watchers;
  {
    const MutexLock lock(&mutex_);
    ended_ = true;
    watchers = Watchers();
  }
  const Fault draining(FaultKind::kDraining, "The server is shutting down.");
  for (const auto& watcher : watchers) watcher->End(draining);
}

Health::State Health::StateOf(const std::string& service) const {
  if (!service.empty() &&
      std::find(services_.begin(), services_.end(), service) == services_.end()) {
    return Response::SERVICE_UNKNOWN;
  }
  const MutexLock lock(&mutex_);
  return serving_ ? Response::SERVING : Response::NOT_SERVING;
}

Status Health::Add(const std::shared_ptr<Reactor>& watcher) {
  const MutexLock lock(&mutex_);
  if (ended_) return Fail(FaultKind::kDraining, "The server is shutting down.");
  if (watchers_.size() >= kMostWatchers) {
    return Fail(app::QuotaFull("max_health_watchers", kMostWatchers));
  }
  watchers_.emplace(watcher.get(), watcher);
  return {};
}

void Health::Remove(const Reactor* watcher) {
  const MutexLock lock(&mutex_);
  watchers_.erase(watcher);
}

std::vector<std::shared_ptr<Health::Reactor>> Health::Watchers() const {
  std::vector<std::shared_ptr<Reactor>> alive;
  for (const auto& [key, watcher] : watchers_) {
    if (auto held = watcher.lock()) alive.push_back(std::move(held));
  }
  return alive;
}

}  // namespace arap::rpc
