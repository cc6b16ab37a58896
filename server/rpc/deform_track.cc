#include "server/rpc/deform_track.h"

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>
#include <grpcpp/server_context.h>

#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/cancel.h"
#include "server/rpc/convert_handles.h"
#include "server/rpc/convert_shape.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/status_map.h"
#include "server/runtime/metrics.h"
#include "server/runtime/stopwatch.h"
#include "server/sessions/names.h"
#include "server/sessions/warm.h"
#include "server/streams/targets.h"

namespace arap::rpc {
namespace {

// Frames that share a pass over the factor: CHOLMOD takes four columns at a time, x and y of two
// frames.
constexpr std::size_t kLanes = 2;

// As StreamDeformReactor: state behind a mutex, every entry pumps, jobs hold a shared pointer.
class DeformTrackReactor final : public grpc::ServerWriteReactor<v1::DeformTrackResponse>,
                                 public app::OpenStream,
                                 public std::enable_shared_from_this<DeformTrackReactor> {
 public:
  DeformTrackReactor(app::Engine& engine, grpc::CallbackServerContext* context,
                     const v1::DeformTrackRequest& request, app::Caller caller)
      : engine_(engine),
        caller_(std::move(caller)),
        cancel_(CancelTokenOf(context)),
        request_(request),
        log_("DeformTrack", request.session_id(), false, &engine.metrics) {}

  // `admitted`: what CallerOf says. Nothing is delivered, and OnDone not called, before the RPC's
  // method has returned.
  void Start(const grpc::CallbackServerContext& context, const Identity& identity,
             const Status& admitted) {
    Begin(admitted);
    if (!admitted) return;
    watch_ = WatchCaller(context, identity, caller_, [weak = weak_from_this()](Fault lost) {
      if (const auto self = weak.lock()) self->End(std::move(lost));
    });
  }

  void End(Fault reason) override {
    const std::lock_guard lock(mutex_);
    if (!end_ && !finished_) end_ = std::move(reason);
    Pump();
  }

  void OnWriteDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) cancelled_ = true;
    Pump();
  }

  void OnCancel() override {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    Pump();
  }

  void OnDone() override {
    engine_.streams.Remove(this);
    watch_ = {};
    const std::shared_ptr<DeformTrackReactor> self = std::move(self_);
    const std::lock_guard lock(mutex_);
    log_.End(end_status_, fmt::format(" frames={}/{}", written_, request_.frames_size()));
  }

 private:
  void Begin(const Status& admitted) {
    const std::lock_guard lock(mutex_);
    self_ = shared_from_this();
    if (auto added = admitted ? engine_.streams.Add(self_, caller_) : admitted; !added) {
      end_ = std::move(added.error());
    } else {
      working_ = engine_.jobs.TryPost([self = self_] { self->RunPrepare(); });
      if (!working_) end_ = app::Overloaded();
    }
    Pump();
  }

  // Starts whatever has become possible. With mutex_ held.
  void Pump() {
    if (finished_) return;
    if (!writing_ && !ready_.empty() && !cancelled_) {
      outgoing_ = std::move(ready_.front());
      ready_.pop_front();
      writing_ = true;
      ++written_;
      StartWrite(&outgoing_);
    }
    if (prepared_ && !working_ && ready_.empty() && !end_ && !cancelled_ &&
        next_frame_ < request_.frames_size()) {
      waiting_ = {};
      working_ = engine_.jobs.Continue([self = self_] { self->RunFrames(); });
      if (!working_) end_ = app::Overloaded();
    }
    if (!working_ && !writing_ && (cancelled_ || ready_.empty())) FinishTrack();
  }

  void FinishTrack() {
    if (cancelled_) {
      end_status_ = Fail(FaultKind::kCancelled, "The caller has cancelled.");
    } else if (end_) {
      end_status_ = Fail(*end_);
    }
    finished_ = true;
    Finish(end_status_ ? grpc::Status::OK : ToGrpcStatus(end_status_.error()));
  }

  void RunPrepare() {
    auto prepared = Prepare();
    const std::lock_guard lock(mutex_);
    prepared_ = prepared.has_value();
    if (!prepared && !end_) end_ = std::move(prepared.error());
    working_ = false;
    Pump();
  }

  void RunFrames() {
    auto frames = Frames();
    const std::lock_guard lock(mutex_);
    if (frames) {
      next_frame_ += static_cast<int>(frames->size());
      for (v1::DeformTrackResponse& frame : *frames) ready_.push_back(std::move(frame));
    } else if (!end_) {
      end_ = std::move(frames.error());
    }
    working_ = false;
    Pump();
  }

  // The jobs' bodies, without mutex_. What they set is theirs while working_.
  Status Prepare() {
    auto session = engine_.sessions.Use(caller_.owner, request_.session_id());
    if (!session) return Fail(std::move(session.error()));
    auto entry = app::WarmHandleSet(engine_, caller_, **session, request_.handle_set_id(), cancel_);
    if (!entry) return Fail(std::move(entry.error()));
    auto options = FromWire(request_.options(), engine_.limits);
    if (!options) return Fail(std::move(options.error()));
    const std::size_t limit = engine_.limits.max_track_frames;
    if (static_cast<std::size_t>(request_.frames_size()) > limit) {
      Fault fault = Fault(FaultKind::kInvalidOption,
                          fmt::format("The track has {} frames, more than max_track_frames of {}.",
                                      request_.frames_size(), limit))
                        .Field("frames");
      return Fail(fault.Detail("count", std::to_string(request_.frames_size()))
                      .Detail("quota", "max_track_frames")
                      .Detail("limit", std::to_string(limit)));
    }
    const std::vector<std::string_view> ids(request_.handle_ids().begin(),
                                            request_.handle_ids().end());
    auto order = app::CompleteOrder(*entry->handles, ids);
    if (!order) return Fail(std::move(order.error()));
    for (int i = 0; i < request_.frames_size(); ++i) {
      auto targets = FromWire(request_.frames(i), static_cast<std::size_t>(i), *order);
      if (!targets) return Fail(std::move(targets.error()));
      if (auto alive = cancel_.Check(); !alive) return alive;
    }
    options_ = *options;
    order_ = *std::move(order);
    revision_ = entry->revision;
    deformer_.emplace(entry->handles, kLanes);
    return {};
  }

  // The next kLanes frames, or only the next one when they fail together: the frames before a bad
  // one are answered, and the fault names the one that it is.
  Result<std::vector<v1::DeformTrackResponse>> Frames() {
    if (auto alive = cancel_.Check(); !alive) return Fail(std::move(alive.error()));
    const std::size_t left = static_cast<std::size_t>(request_.frames_size() - next_frame_);
    auto frames = Solve(std::min(kLanes, left));
    if (!frames && left > 1) frames = Solve(1);
    return frames;
  }

  Result<std::vector<v1::DeformTrackResponse>> Solve(std::size_t count) {
    const double queue_micros = waiting_.Micros();
    const runtime::Stopwatch working;
    const auto first = static_cast<std::size_t>(next_frame_);
    std::array<std::vector<Target>, kLanes> targets;
    std::array<std::span<const Target>, kLanes> views;
    std::array<ShapeQuality, kLanes> qualities;
    for (std::size_t i = 0; i < count; ++i) {
      auto frame = FromWire(request_.frames(static_cast<int>(first + i)), first + i, order_);
      if (!frame) return Fail(std::move(frame.error()));
      targets[i] = *std::move(frame);
      views[i] = targets[i];
    }
    if (auto done =
            deformer_->UpdateMany(std::span(views).first(count), options_.deform, qualities);
        !done) {
      return Fail(AtFrame(std::move(done.error()), first));
    }
    std::vector<v1::DeformTrackResponse> responses(count);
    for (std::size_t i = 0; i < count; ++i) {
      v1::Shape& shape = *responses[i].mutable_shape();
      if (auto good = ToWire(*deformer_, qualities[i], options_, &shape, i); !good) {
        return Fail(AtFrame(std::move(good.error()), first + i));
      }
      shape.set_sequence(first + i);
      shape.set_handle_set_revision(revision_);
      shape.set_queue_micros(queue_micros);
      shape.set_solve_micros(working.Micros() / static_cast<double>(count));
      engine_.metrics.Phase(runtime::Phase::kTrack, shape.solve_micros() * 1e-6);
    }
    return responses;
  }

  static Fault AtFrame(Fault fault, std::size_t index) {
    fault.message = fmt::format("frames[{}]: {}", index, fault.message);
    return fault.Detail("frame", std::to_string(index)).Field(fmt::format("frames[{}]", index));
  }

  app::Engine& engine_;
  const app::Caller caller_;
  app::TokenWatch watch_;  // from Start until OnDone
  const CancelToken cancel_;
  const v1::DeformTrackRequest& request_;  // gRPC's, until the call is done
  std::shared_ptr<DeformTrackReactor> self_;

  // The running job's own.
  ShapeOptions options_;
  std::vector<std::size_t> order_;
  std::uint64_t revision_ = 0;
  std::optional<Deformer> deformer_;
  runtime::Stopwatch waiting_;

  std::mutex mutex_;
  // All below is guarded by mutex_.
  bool prepared_ = false;
  bool working_ = false;
  int next_frame_ = 0;
  std::deque<v1::DeformTrackResponse> ready_;  // at most kLanes
  v1::DeformTrackResponse outgoing_;           // gRPC's while writing_
  bool writing_ = false;
  int written_ = 0;
  std::optional<Fault> end_;
  bool cancelled_ = false;
  bool finished_ = false;
  Status end_status_;
  RpcLog log_;
};

}  // namespace

grpc::ServerWriteReactor<v1::DeformTrackResponse>* DeformTrack(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context,
    const v1::DeformTrackRequest* request) {
  const auto caller = CallerOf(*context, identity);
  const auto reactor = std::make_shared<DeformTrackReactor>(engine, context, *request,
                                                            caller.value_or(app::Caller{}));
  reactor->Start(*context, identity, caller ? Status() : Fail(caller.error()));
  return reactor.get();
}

}  // namespace arap::rpc
