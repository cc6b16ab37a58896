#include "server/rpc/deform_track.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>
#include <grpcpp/server_context.h>

#include "server/app/engine.h"
#include "server/app/names.h"
#include "server/app/targets.h"
#include "server/rpc/cancel.h"
#include "server/rpc/convert_handles.h"
#include "server/rpc/convert_shape.h"
#include "server/rpc/rpc_log.h"
#include "server/rpc/status_map.h"
#include "server/runtime/stopwatch.h"

namespace arap::rpc {
namespace {

// As StreamDeformReactor: state behind a mutex, every entry pumps, jobs hold a shared pointer.
class DeformTrackReactor final : public grpc::ServerWriteReactor<v1::DeformTrackResponse>,
                                 public app::OpenStream,
                                 public std::enable_shared_from_this<DeformTrackReactor> {
 public:
  DeformTrackReactor(app::Engine& engine, grpc::CallbackServerContext* context,
                     const v1::DeformTrackRequest& request)
      : engine_(engine),
        cancel_(CancelTokenOf(context)),
        request_(request),
        log_("DeformTrack", request.session_id(), false) {}

  void Start() {
    const std::lock_guard lock(mutex_);
    self_ = shared_from_this();
    if (auto added = engine_.streams.Add(self_); !added) {
      end_ = std::move(added.error());
    } else {
      working_ = engine_.jobs.TryPost([self = self_] { self->RunPrepare(); });
      if (!working_) end_ = app::Overloaded();
    }
    Pump();
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
    const std::shared_ptr<DeformTrackReactor> self = std::move(self_);
    const std::lock_guard lock(mutex_);
    log_.End(end_status_, fmt::format(" frames={}/{}", written_, request_.frames_size()));
  }

 private:
  // Starts whatever has become possible. With mutex_ held.
  void Pump() {
    if (finished_) return;
    if (!writing_ && ready_ && !cancelled_) {
      outgoing_ = std::move(*ready_);
      ready_.reset();
      writing_ = true;
      ++written_;
      StartWrite(&outgoing_);
    }
    if (prepared_ && !working_ && !ready_ && !end_ && !cancelled_ &&
        next_frame_ < request_.frames_size()) {
      waiting_ = {};
      working_ = engine_.jobs.Continue([self = self_] { self->RunFrame(); });
      if (!working_) end_ = app::Overloaded();
    }
    if (!working_ && !writing_ && (cancelled_ || !ready_)) FinishTrack();
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

  void RunFrame() {
    auto frame = Frame();
    const std::lock_guard lock(mutex_);
    if (frame) {
      ready_ = *std::move(frame);
      ++next_frame_;
    } else if (!end_) {
      end_ = std::move(frame.error());
    }
    working_ = false;
    Pump();
  }

  // The jobs' bodies, without mutex_. What they set is theirs while working_.
  Status Prepare() {
    auto session = engine_.sessions.Use(request_.session_id());
    if (!session) return Fail(std::move(session.error()));
    auto entry = (*session)->FindHandleSet(request_.handle_set_id());
    if (!entry) return Fail(std::move(entry.error()));
    auto options = FromWire(request_.options(), engine_.limits);
    if (!options) return Fail(std::move(options.error()));
    const std::size_t limit = engine_.limits.max_track_frames;
    if (static_cast<std::size_t>(request_.frames_size()) > limit) {
      Fault fault{FaultKind::kInvalidOption,
                  fmt::format("The track has {} frames, more than max_track_frames of {}.",
                              request_.frames_size(), limit),
                  {},
                  {},
                  "frames"};
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
    deformer_.emplace(entry->handles);
    return {};
  }

  Result<v1::DeformTrackResponse> Frame() {
    const double queue_micros = waiting_.Micros();
    const runtime::Stopwatch working;
    if (auto alive = cancel_.Check(); !alive) return Fail(std::move(alive.error()));
    const auto index = static_cast<std::size_t>(next_frame_);
    auto targets = FromWire(request_.frames(next_frame_), index, order_);
    if (!targets) return Fail(std::move(targets.error()));
    v1::DeformTrackResponse response;
    v1::Shape& shape = *response.mutable_shape();
    auto quality = deformer_->Update(*targets, options_.deform);
    if (!quality) return Fail(AtFrame(std::move(quality.error()), index));
    if (auto good = ToWire(*deformer_, *quality, options_, &shape); !good) {
      return Fail(AtFrame(std::move(good.error()), index));
    }
    shape.set_sequence(index);
    shape.set_handle_set_revision(revision_);
    shape.set_queue_micros(queue_micros);
    shape.set_solve_micros(working.Micros());
    return response;
  }

  static Fault AtFrame(Fault fault, std::size_t index) {
    fault.message = fmt::format("frames[{}]: {}", index, fault.message);
    return fault.Detail("frame", std::to_string(index)).Field(fmt::format("frames[{}]", index));
  }

  app::Engine& engine_;
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
  std::optional<v1::DeformTrackResponse> ready_;
  v1::DeformTrackResponse outgoing_;  // gRPC's while writing_
  bool writing_ = false;
  int written_ = 0;
  std::optional<Fault> end_;
  bool cancelled_ = false;
  bool finished_ = false;
  Status end_status_;
  const RpcLog log_;
};

}  // namespace

grpc::ServerWriteReactor<v1::DeformTrackResponse>* DeformTrack(
    app::Engine& engine, grpc::CallbackServerContext* context,
    const v1::DeformTrackRequest* request) {
  const auto reactor = std::make_shared<DeformTrackReactor>(engine, context, *request);
  reactor->Start();
  return reactor.get();
}

}  // namespace arap::rpc
