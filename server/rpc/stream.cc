#include <cstdint>
#include <memory>
#include <utility>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>
#include <grpcpp/server_context.h>

#include "core/base/cpu_timer.h"
#include "core/base/mutex.h"
#include "core/base/try.h"
#include "proto/convert/status.h"
#include "server/budget/faults.h"
#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/convert.h"
#include "server/rpc/long_calls.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/stream_work.h"
#include "server/runtime/clock.h"
#include "server/streams/stream_policy.h"

namespace arap::rpc {
namespace {

struct Answer final : app::WireAnswer {
  v1::StreamDeformResponse message;
};

// Reactions, jobs, End and Sweep may run in parallel. Each tells the policy what has happened and
// pumps: does what the policy says next. Jobs and drains hold a shared pointer, so that nothing is
// deleted under them. A small frame is computed in the reaction that has made it due, when its lane
// gives leave (WorkerPool::TryVisit): gRPC does not call OnDone before a reaction has returned.
class StreamReactor final
    : public grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>,
      public app::LongCall,
      public std::enable_shared_from_this<StreamReactor> {
 public:
  StreamReactor(app::Engine& engine, grpc::CallbackServerContext* context, app::Caller caller)
      : engine_(engine),
        context_(context),
        caller_(std::move(caller)),
        policy_(engine.limits, engine.clock,
                {[this](double share) {
                   return engine_.admission.MayOpen(caller_.owner, share, Now());
                 },
                 [this](double share) {
                   return engine_.admission.WakeUp(this, caller_.owner, share, Now());
                 },
                 [this](double share) { engine_.admission.StaysAwake(this, share, Now()); }}),
        log_("StreamDeform", "", false, &engine.metrics),
        work_(engine, caller_) {
    log_.NamedLasting(*context);
    log_.Owner(caller_.owner);
  }

  // `admitted`: what CallerOf says. `identity` is looked at before this returns. Nothing is
  // delivered, and OnDone not called, before the RPC's method has returned.
  void Start(const Identity& identity, const Status& admitted) {
    self_ = shared_from_this();
    if (identity.connections != nullptr)
      counted_ = identity.connections->Begin(context_->peer(), admitted.has_value());
    const Status added = admitted ? engine_.streams.Add(self_, caller_) : admitted;
    {
      const MutexLock lock(&mutex_);
      if (!added) policy_.End(added.error());
      Pump();
    }
    if (!added) return;
    watch_ = WatchCaller(*context_, identity, caller_, [weak = weak_from_this()](Fault lost) {
      if (const auto self = weak.lock()) self->End(std::move(lost));
    });
  }

  void OnReadDone(bool ok) override {
    Visit visit;
    {
      const MutexLock lock(&mutex_);
      ok ? Read() : policy_.HalfClosed();
      Pump(&visit);
    }
    if (visit) RunUpdate();
  }

  void OnWriteDone(bool ok) override {
    Visit visit;
    {
      const MutexLock lock(&mutex_);
      // The next frame is written into what this one has left.
      if (outgoing_->message.has_shape()) {
        outgoing_->message.mutable_shape()->Clear();
        spare_ = std::move(outgoing_);
      }
      policy_.Written(ok);
      Pump(&visit);
    }
    if (visit) RunUpdate();
  }

  void OnCancel() override {
    const MutexLock lock(&mutex_);
    policy_.Cancelled();
    Pump();
  }

  void End(Fault reason) override {
    const MutexLock lock(&mutex_);
    policy_.End(std::move(reason));
    Pump();
  }

  void Sweep(runtime::Clock::Steady now) override {
    const MutexLock lock(&mutex_);
    if (policy_.Sweep(now)) context_->TryCancel();
    Pump();
  }

  void OnDone() override {
    engine_.streams.Remove(this);
    engine_.admission.Leave(this);
    watch_ = {};
    const std::shared_ptr<StreamReactor> self = std::move(self_);
    {
      const MutexLock lock(&mutex_);
      const auto& counts = policy_.counts();
      log_.End(end_status_, fmt::format(" shapes={} replaced={} errors={}", counts.shapes,
                                        counts.replaced, counts.errors));
    }
    if (const auto& session = work_.session()) session->RemoveEndListener(end_listener_);
  }

 private:
  using Visit = runtime::WorkerPool::Visit;

  runtime::Clock::Steady Now() const { return engine_.clock.SteadyNow(); }

  // The memory of a message counts until the next one is read.
  void Read() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    message_room_.Release();
    if (auto room = engine_.derived.ReserveForRequest(caller_, incoming_.SpaceUsedLong())) {
      message_room_ = *std::move(room);
    } else {
      policy_.End(std::move(room.error()));
    }
    policy_.MessageRead(FromWire(incoming_, engine_.limits));
  }

  // With `visit` the caller may become the one who computes the next frame: if it is set, it has to
  // call RunUpdate without the lock.
  void Pump(Visit* visit = nullptr) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    for (;;) {
      app::StreamStep step = policy_.Next();
      if (std::holds_alternative<app::StreamRead>(step)) {
        read_due_ = true;
      } else if (auto* job = std::get_if<app::StreamJob>(&step)) {
        StartJob(std::move(*job), visit);
      } else if (auto* write = std::get_if<app::StreamWrite>(&step)) {
        Write(std::move(write->answer));
      } else if (auto* finish = std::get_if<app::StreamFinish>(&step)) {
        end_status_ = std::move(finish->status);
        read_due_ = false;
        Finish(end_status_ ? grpc::Status::OK : convert::ToGrpcStatus(end_status_.error()));
      } else {
        break;
      }
    }
    // Behind the rest: it takes gRPC some 10 µs, and nobody waits for it.
    const bool computes = visit != nullptr && *visit;
    if (!computes && std::exchange(read_due_, false)) StartRead(&incoming_);
  }

  void Write(app::StreamAnswer answer) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    using Kind = app::StreamAnswer::Kind;
    outgoing_.reset(static_cast<Answer*>(answer.message.release()));
    if (!outgoing_) outgoing_ = std::make_unique<Answer>();
    Complete(answer, outgoing_->message);
    if (answer.kind == Kind::kShape) engine_.metrics.Coalesced(answer.replaced);
    if (answer.kind == Kind::kError) CountRefusal(*answer.fault, engine_.metrics);
    StartWrite(&outgoing_->message);
  }

  void StartJob(app::StreamJob job, Visit* visit) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    using Work = app::StreamJob::Work;
    job_ = std::move(job);
    void (StreamReactor::*run)() = &StreamReactor::RunUpdate;
    if (job_.work == Work::kOpen) {
      run = &StreamReactor::RunFind;
      open_ = std::move(*incoming_.mutable_open());
      log_.Opened(open_.session_id());
    } else if (job_.work == Work::kEdit) {
      run = &StreamReactor::RunEdit;
      edit_ = std::move(*incoming_.mutable_edit());
    }
    if (job_.work == Work::kUpdate) {
      answer_ = std::move(spare_);
      if (visit != nullptr && job_.lane == app::StreamJob::Lane::kFrames &&
          (*visit = engine_.interactive.TryVisit(Turn()))) {
        return;
      }
    }
    if (!Post(job_.lane, run)) policy_.NoRoom();
  }

  // Every stream has its own turn among those of its owner.
  runtime::Share Turn() const {
    return {caller_.owner, reinterpret_cast<std::uintptr_t>(this), job_.seconds};
  }

  bool Post(app::StreamJob::Lane lane, void (StreamReactor::*job)()) {
    using Lane = app::StreamJob::Lane;
    runtime::WorkerPool& pool = lane == Lane::kControl  ? engine_.control
                                : lane == Lane::kFrames ? engine_.interactive
                                                        : engine_.jobs;
    // Whoever was let in is not refused a frame because of the calls of others.
    const bool goes_on = lane == Lane::kFrames ||
                         (lane == Lane::kJobs && job_.work == app::StreamJob::Work::kUpdate);
    auto run = [self = shared_from_this(), job] { (self.get()->*job)(); };
    if (!goes_on) return pool.TryPost(std::move(run), Turn());
    runtime::Company company;
    if (lane == Lane::kFrames && job_.work == app::StreamJob::Work::kUpdate) {
      company = {SharedFactor(work_.handles()), shared_from_this()};
    }
    return pool.Continue(std::move(run), Turn(), std::move(company));
  }

  // The bodies of the jobs, without mutex_.

  // The store may be slow and what was evicted has to be computed again: neither on the lane of
  // frames.
  void RunFind() {
    const auto found = OrOutOfMemory([&] { return work_.Find(open_); });
    if (found) {
      if (*found != app::Warmth::kCold) return RunOpen();
      job_.seconds = 1;  // long, and nothing more is known
      if (Post(app::StreamJob::Lane::kJobs, &StreamReactor::RunOpen)) return;
    }
    const MutexLock lock(&mutex_);
    policy_.Failed(found ? app::Overloaded() : found.error());
    Pump();
  }

  void RunOpen() {
    auto answer = std::make_unique<Answer>();
    const auto admit = [this](double seconds) {
      const MutexLock lock(&mutex_);
      return policy_.AdmitFrames(seconds);
    };
    auto set = OrOutOfMemory([&]() -> Result<app::LiveHandles> {
      CHECK_OK(work_.Open(open_, CancelTokenOf(context_), admit, answer->message.mutable_opened()));
      return work_.Handles(work_.handles().RestTargets());
    });
    open_.clear_options();
    if (set) {
      end_listener_ = work_.session()->AddEndListener(
          [weak = weak_from_this(), ended = app::NotFound("session", open_.session_id())] {
            if (const auto self = weak.lock()) self->End(ended);
          });
    }
    const MutexLock lock(&mutex_);
    if (set) {
      policy_.Opened(
          *std::move(set), work_.latest_only(), work_.options().deform.measure_every,
          [session = work_.session()] { return session->Touch(); }, std::move(answer));
    } else {
      policy_.Failed(set.error());
    }
    Pump();
  }

  // Also the frame of another stream of the mesh that waits, when there is one: two frames in one
  // pass over the factor take less than two passes.
  void RunUpdate() {
    const auto other = std::static_pointer_cast<StreamReactor>(runtime::TakeAlong());
    const double queued = job_.waiting.Micros();
    const runtime::WallTimer working;
    CpuTimer processor;
    if (other == nullptr) {
      auto quality = OrOutOfMemory([this] {
        return work_.live().Move(job_.targets, JobOptions(), engine_.metrics,
                                 CancelTokenOf(context_));
      });
      return AnswerUpdate(std::move(quality), {queued, working},
                          processor.Lap() + work_.live().helped_seconds() * 1e3);
    }
    const double other_queued = other->job_.waiting.Micros();
    JointFrame ours = NextFrame(), theirs = other->NextFrame();
    const double helped = app::LiveSet::MoveTogether(ours, theirs, engine_.metrics);
    const double each = (processor.Lap() + helped * 1e3) / 2;
    AnswerUpdate(std::move(ours.quality), {queued, working, 2}, each);
    other->AnswerUpdate(std::move(theirs.quality), {other_queued, working, 2}, each);
  }

  DeformOptions JobOptions() const {
    DeformOptions options = work_.options().deform;
    options.measure_every = job_.measure ? 1 : 0;
    return options;
  }
  JointFrame NextFrame() {
    return work_.live().FrameOf(job_.targets, JobOptions(), CancelTokenOf(context_));
  }

  // The shape that live_ has now, of this quality, after so many milliseconds of the processor.
  void AnswerUpdate(Result<ShapeQuality> quality, const ShapeTimes& times, double milliseconds) {
    CpuTimer processor;
    auto answer = answer_ ? std::move(answer_) : std::make_unique<Answer>();
    const Status made = OrOutOfMemory([&]() -> Status {
      if (!quality) return Fail(std::move(quality).error());
      return ToWire(work_.live(), *quality, work_.options(), job_.picks, CancelTokenOf(context_),
                    times, answer->message.mutable_shape());
    });
    const double took = (milliseconds + processor.Lap()) * 1e-3;
    const MutexLock lock(&mutex_);
    policy_.FrameTook(took);
    made ? policy_.Moved(std::move(answer)) : policy_.Failed(made.error());
    Pump();
  }

  void RunEdit() {
    const double queue_micros = job_.waiting.Micros();
    const runtime::WallTimer working;
    auto answer = std::make_unique<Answer>();
    auto targets = OrOutOfMemory([&] {
      return work_.Edit(edit_, job_.targets, CancelTokenOf(context_), {queue_micros, working},
                        answer->message.mutable_shape());
    });
    const MutexLock lock(&mutex_);
    if (targets) {
      policy_.Edited(work_.Handles(*std::move(targets)), std::move(answer));
    } else {
      policy_.Failed(std::move(targets.error()));
    }
    Pump();
  }

  app::Engine& engine_;
  grpc::CallbackServerContext* const context_;
  const app::Caller caller_;
  CallerWatch watch_;                    // from Start until OnDone
  std::shared_ptr<StreamReactor> self_;  // likewise
  std::shared_ptr<const void> counted_;

  Mutex mutex_;
  app::StreamPolicy policy_ ABSL_GUARDED_BY(mutex_);
  // gRPC's while it reads and writes.
  v1::StreamDeformRequest incoming_ ABSL_GUARDED_BY(mutex_);
  bool read_due_ ABSL_GUARDED_BY(mutex_) = false;  // the next message is to be read into it
  std::unique_ptr<Answer> outgoing_ ABSL_GUARDED_BY(mutex_);
  // With a cleared shape that has kept its memory, or none. Those that are computed, wait and are
  // written are never more than three, with this one among them (LiveSet::BytesOf).
  std::unique_ptr<Answer> spare_ ABSL_GUARDED_BY(mutex_);
  RpcLog log_ ABSL_GUARDED_BY(mutex_);
  Status end_status_ ABSL_GUARDED_BY(mutex_);
  app::DerivedCache::Reservation message_room_ ABSL_GUARDED_BY(mutex_);

  // The running job's own; when none runs, of whoever holds mutex_.
  app::StreamJob job_;
  std::unique_ptr<Answer> answer_;  // kUpdate: to be filled, or none
  v1::OpenStream open_;
  v1::HandleEdit edit_;
  std::uint64_t end_listener_ = 0;
  StreamWork work_;
};

}  // namespace

grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>* StreamDeform(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  auto caller = CallerOf(*context, identity);
  const auto reactor =
      std::make_shared<StreamReactor>(engine, context, caller.value_or(app::Caller{"", {}, {}}));
  reactor->Start(identity, caller ? Status() : Fail(std::move(caller.error())));
  return reactor.get();
}

}  // namespace arap::rpc
