#include "server/rpc/unary.h"

#include <utility>

#include "core/base/names.h"
#include "proto/convert/status.h"
#include "server/budget/estimate.h"
#include "server/budget/faults.h"
#include "server/rpc/rpc_log.h"
#include "server/runtime/clock.h"
#include "server/runtime/worker_pool.h"

namespace arap::rpc {
namespace {

// Steps on lanes, one after the other. Finish is called exactly once, at the end of the last, so
// that nothing is deleted under a worker.
class UnaryReactor final : public grpc::ServerUnaryReactor {
 public:
  UnaryReactor(const Backend& backend, const Method& method, grpc::CallbackServerContext* context,
               UnaryJob job)
      : engine_(backend.engine),
        method_(method),
        job_(std::move(job)),
        log_(method.name, job_.session_id, method.noisy, &engine_.metrics) {
    call_.cancel = CancelTokenOf(context);
  }

  void Start(Result<app::Caller> caller) {
    if (!caller) return End(Fail(std::move(caller.error())));
    call_.caller = *std::move(caller);
    log_.Owner(call_.caller.owner);
    auto room = engine_.derived.Reserve(call_.caller, app::RequestBytes(job_.bytes));
    if (!room) return End(Fail(std::move(room.error())));
    room_ = *std::move(room);
    if (method_.gate != nullptr) {
      auto pass = method_.gate->Enter(call_.caller.owner);
      if (!pass) return End(Fail(WithOutlook(std::move(pass.error()), engine_.jobs)));
      pass_ = *std::move(pass);
    }
    switch (method_.cost) {
      case Cost::kTrivial:
        return Work();
      case Cost::kStore:
        return Post(engine_.control, &UnaryReactor::Work);
      case Cost::kHeavy:
        Expect(engine_.sessions.Glance(call_.caller.owner, job_.session_id).get());
        return Post(engine_.jobs, &UnaryReactor::Work);
      case Cost::kLookUp:
      case Cost::kFrame:
        call_.session = engine_.sessions.Peek(call_.caller.owner, job_.session_id);
        if (method_.cost == Cost::kFrame && call_.session) {
          Expect(call_.session.get());
          return Compute();
        }
        return Post(engine_.control, &UnaryReactor::LookUp);
    }
  }

  void OnDone() override { delete this; }

 private:
  void Post(runtime::WorkerPool& lane, void (UnaryReactor::*step)()) {
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

  void Expect(const app::Session* session) {
    if (job_.expect) expected_ = job_.expect(session);
  }

  // Where there is time for what the session is in memory for.
  void Compute() {
    const bool is_long = expected_.cold || expected_.seconds > app::kLongFrameSeconds;
    Post(is_long ? engine_.jobs : engine_.interactive, &UnaryReactor::Work);
  }

  void LookUp() {
    if (auto alive = call_.cancel.Check(); !alive) return End(alive);
    auto session = app::WithinMemory([&] { return SessionOf(engine_, call_, job_.session_id); });
    if (!session) return End(Fail(std::move(session.error())));
    call_.session = *std::move(session);
    Expect(call_.session.get());
    const bool is_long = expected_.cold || expected_.seconds > app::kLongFrameSeconds;
    if (method_.cost == Cost::kFrame || is_long) return Compute();
    Work();
  }

  void Work() {
    if (method_.cost != Cost::kTrivial) call_.queue_micros = waiting_.Micros();
    const Status alive = call_.cancel.Check();
    End(alive ? app::WithinMemory([&] { return job_.work(call_); }) : alive);
  }

  // The last thing that happens to this object.
  void End(const Status& status) {
    pass_.reset();
    room_.Release();
    log_.End(status);
    Finish(status ? grpc::Status::OK : convert::ToGrpcStatus(status.error()));
  }

  app::Engine& engine_;
  const Method method_;
  const UnaryJob job_;
  Call call_;
  app::DerivedCache::Reservation room_;  // for the request
  app::Gate::Pass pass_;
  Expected expected_;
  RpcLog log_;
  const runtime::WallTimer waiting_;
};

}  // namespace

Result<std::shared_ptr<app::Session>> SessionOf(app::Engine& engine, const Call& call,
                                                const std::string& session_id) {
  if (call.session) return call.session;
  return engine.sessions.Use(call.caller.owner, session_id);
}

Status CheckSize(const Limits& limits, std::size_t request_bytes) {
  const std::size_t most = limits.max_message_bytes;
  if (request_bytes <= most) return {};
  return Fail(app::TooLarge("The request", "max_message_bytes", request_bytes, most));
}

grpc::ServerUnaryReactor* RunUnary(const Backend& backend, const Method& method,
                                   grpc::CallbackServerContext* context, UnaryJob job) {
  auto caller = CallerOf(*context, backend.identity);
  // To those who are refused elsewhere, an open method answers as to nobody.
  if (!caller && method.open_to_all) {
    caller = app::Caller{app::kNobody, app::Role::kUser, backend.identity.limits};
  }
  auto* reactor = new UnaryReactor(backend, method, context, std::move(job));
  reactor->Start(std::move(caller));
  return reactor;
}

}  // namespace arap::rpc
