#include "server/rpc/unary.h"

#include <atomic>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "proto/convert/status.h"
#include "server/budget/faults.h"
#include "server/rpc/connections.h"
#include "server/rpc/rpc_log.h"
#include "server/runtime/clock.h"
#include "server/runtime/worker_pool.h"

namespace arap::rpc {
namespace {

// Requests up to this size are taken apart on gRPC's threads: it takes less time than a lane's
// queue.
constexpr std::size_t kSmall = 64u << 10u;

// The request, then steps on lanes, one after the other. Finish is called exactly once, at the end
// of the last, so that nothing is deleted under a worker.
class UnaryReactor final : public UnaryStream, public std::enable_shared_from_this<UnaryReactor> {
 public:
  UnaryReactor(const Backend& backend, const Method& method, grpc::CallbackServerContext* context,
               std::unique_ptr<UnaryJob> job)
      : engine_(backend.engine),
        method_(method),
        context_(context),
        job_(std::move(job)),
        log_(method.name, "", method.noisy, &engine_.metrics) {
    call_.cancel = CancelTokenOf(context);
    log_.Named(*context);
  }

  // `let_in`: whether the caller is known, without whom an open method is served too.
  void Start(const Identity& identity, const std::string& peer, bool let_in,
             Result<app::Caller> caller) {
    self_ = shared_from_this();
    if (identity.connections != nullptr) counted_ = identity.connections->Begin(peer, let_in);
    if (!caller) return End(Fail(std::move(caller.error())));
    call_.caller = *std::move(caller);
    log_.Owner(call_.caller.owner);
    if (method_.cost == Cost::kTrivial) return Work();
    if (identity.connections != nullptr) {
      auto receiving =
          identity.connections->Receive(peer, [weak = weak_from_this()](const Fault& late) {
            if (const auto self = weak.lock()) self->Late(late);
          });
      if (!receiving) return End(Fail(std::move(receiving.error())));
      receiving_ = *std::move(receiving);
    }
    StartRead(&bytes_);
  }

  void OnReadDone(bool ok) override {
    if (arrived_.exchange(true)) return;  // too late
    const std::size_t size = ok ? bytes_.Length() : 0;
    receiving_.Received(size);
    waiting_ = {};
    log_.Arrived();
    if (!ok) {
      const Status alive = call_.cancel.Check();
      return End(alive ? Fail(FaultKind::kCancelled, "The call ended without a request.") : alive);
    }
    // Taking it apart makes another one of the same size, before the bytes go.
    if (auto room = MakeRoom(size > kSmall ? 2 * size : size); !room) return End(room);
    if (method_.gate != nullptr) {
      auto pass = method_.gate->Enter(call_.caller.owner);
      if (!pass) return End(Fail(WithOutlook(std::move(pass.error()), engine_.jobs)));
      pass_ = *std::move(pass);
    }
    if (size > kSmall) return Post(engine_.control, &UnaryReactor::ParseAndGoOn);
    ParseAndGoOn();
  }

  void OnDone() override { const auto self = std::move(self_); }

 private:
  void Late(const Fault& fault) {
    if (!arrived_.exchange(true)) End(Fail(fault));
  }

  // Memory for a request of so many bytes, in place of what was kept for it before.
  Status MakeRoom(std::size_t bytes) {
    const std::size_t most = engine_.limits.max_message_bytes;
    if (bytes_.Length() > most) {
      return Fail(app::TooLarge("The request", "max_message_bytes", bytes_.Length(), most));
    }
    room_.Release();
    TRY(room_, engine_.derived.ReserveForRequest(call_.caller, bytes));
    return {};
  }

  void Post(runtime::WorkerPool& lane, void (UnaryReactor::*step)()) {
    if (&lane == &engine_.jobs) queued_ = Queued{lane.OutlookOf(call_.caller.owner).place, {}, {}};
    if (lane.TryPost([this, step] { (this->*step)(); },
                     {call_.caller.owner, 0, expected_.seconds})) {
      return;
    }
    End(Fail(WithOutlook(app::Overloaded(), lane)));
  }

  Fault WithOutlook(Fault fault, const runtime::WorkerPool& lane) const {
    const auto outlook = lane.OutlookOf(call_.caller.owner);
    return app::WithOutlook(std::move(fault), outlook.place, outlook.wait);
  }

  // Where there is time for what the session is in memory for.
  void Compute() { Post(IsLong() ? engine_.jobs : engine_.interactive, &UnaryReactor::Work); }
  bool IsLong() const { return expected_.cold || expected_.seconds > app::kLongFrameSeconds; }

  Status Parse() {
    if (!job_->Parse(&bytes_)) {
      return Fail(FaultKind::kInvalidOption,
                  "The bytes of the request are not of its message type.");
    }
    log_.Session(job_->session_id());
    CHECK_OK(MakeRoom(job_->bytes()));
    bytes_.Clear();
    return {};
  }

  void ParseAndGoOn() {
    if (auto parsed = OrOutOfMemory([&] { return Parse(); }); !parsed) return End(parsed);
    const std::string& owner = call_.caller.owner;
    switch (method_.cost) {
      case Cost::kTrivial:
      case Cost::kStore:
        return Post(engine_.control, &UnaryReactor::Work);
      case Cost::kHeavy:
        expected_ = job_->Expect(engine_.sessions.Glance(owner, job_->session_id()).get());
        return Post(engine_.jobs, &UnaryReactor::Work);
      case Cost::kLookUp:
      case Cost::kFrame:
        call_.session = engine_.sessions.Peek(owner, job_->session_id());
        if (method_.cost == Cost::kFrame && call_.session) {
          expected_ = job_->Expect(call_.session.get());
          return Compute();
        }
        return Post(engine_.control, &UnaryReactor::LookUp);
    }
  }

  void LookUp() {
    if (auto alive = call_.cancel.Check(); !alive) return End(alive);
    auto session = OrOutOfMemory([&] { return SessionOf(engine_, call_, job_->session_id()); });
    if (!session) return End(Fail(std::move(session.error())));
    call_.session = *std::move(session);
    expected_ = job_->Expect(call_.session.get());
    if (method_.cost == Cost::kFrame || IsLong()) return Compute();
    Work();
  }

  void Work() {
    if (method_.cost != Cost::kTrivial) call_.queue_micros = waiting_.Micros();
    if (queued_) queued_->waited_micros = queued_->since.Micros();
    const Status alive = call_.cancel.Check();
    End(alive ? OrOutOfMemory([&] { return Answer(); }) : alive);
  }

  Status Answer() {
    CHECK_OK(job_->Work(call_));
    if (job_->Answer(&bytes_)) return {};
    return Fail(FaultKind::kInternal, "The answer is too large for one message.");
  }

  // What the caller of a job is told of its queue. Before the answer.
  void TellOfQueue() {
    if (!queued_ || !queued_->waited_micros) return;
    context_->AddTrailingMetadata(kQueuePlace, fmt::format("{}", queued_->place));
    context_->AddTrailingMetadata(kQueueWait,
                                  fmt::format("{:.1f}", 1e-3 * *queued_->waited_micros));
  }

  // The last thing that happens to this object.
  void End(const Status& status) {
    pass_.reset();
    room_.Release();
    log_.End(status);
    if (status) TellOfQueue();
    // What was taken apart is freed here and not in gRPC's thread, which others wait for.
    const std::unique_ptr<UnaryJob> job = std::move(job_);
    if (status) return StartWriteAndFinish(&bytes_, grpc::WriteOptions(), grpc::Status::OK);
    Finish(convert::ToGrpcStatus(status.error()));
  }

  // How the call fared in the queue of jobs.
  struct Queued {
    std::size_t place = 0;  // when it was accepted
    runtime::WallTimer since;
    std::optional<double> waited_micros;  // when it has begun
  };

  app::Engine& engine_;
  const Method method_;
  grpc::CallbackServerContext* const context_;
  std::unique_ptr<UnaryJob> job_;       // until the end
  std::shared_ptr<UnaryReactor> self_;  // from Start until OnDone
  grpc::ByteBuffer bytes_;              // the request, then the answer; gRPC's meanwhile
  std::atomic<bool> arrived_{false};    // or given up
  std::shared_ptr<const void> counted_;
  Connections::Entry receiving_;
  Call call_;
  app::DerivedCache::Reservation room_;  // for the request
  app::Gate::Pass pass_;
  Expected expected_;
  std::optional<Queued> queued_;
  RpcLog log_;
  runtime::WallTimer waiting_;
};

}  // namespace

Result<std::shared_ptr<app::Session>> SessionOf(app::Engine& engine, const Call& call,
                                                const std::string& session_id) {
  if (call.session) return call.session;
  return engine.sessions.Use(call.caller.owner, session_id);
}

UnaryStream* RunUnary(const Backend& backend, const Method& method,
                      grpc::CallbackServerContext* context, std::unique_ptr<UnaryJob> job) {
  auto caller = CallerOf(*context, backend.identity);
  const bool let_in = caller.has_value();
  // To those who are refused elsewhere, an open method answers as to nobody.
  if (!caller && method.open_to_all) {
    caller = app::Caller{app::kNobody, app::Role::kUser, backend.identity.limits};
  }
  const auto reactor = std::make_shared<UnaryReactor>(backend, method, context, std::move(job));
  reactor->Start(backend.identity, context->peer(), let_in, std::move(caller));
  return reactor.get();
}

}  // namespace arap::rpc
