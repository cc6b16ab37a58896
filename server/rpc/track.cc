#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>

#include "core/base/mutex.h"
#include "core/base/try.h"
#include "server/budget/faults.h"
#include "server/engine.h"
#include "server/rpc/convert.h"
#include "server/rpc/long_answer.h"
#include "server/rpc/long_calls.h"
#include "server/rpc/unary.h"
#include "server/runtime/clock.h"
#include "server/sessions/handle_sets.h"
#include "server/streams/live_set.h"
#include "server/streams/targets.h"

namespace arap::rpc {
namespace {

// Frames that share a pass over the factor: CHOLMOD takes four columns at a time, x and y of two
// frames.
constexpr std::size_t kLanes = 2;

// The frames that are sent to a client, and what they were computed from.
class TrackReactor final : public LongAnswer<v1::DeformTrackRequest, v1::DeformTrackResponse> {
 public:
  TrackReactor(app::Engine& engine, grpc::CallbackServerContext* context, app::Caller caller)
      : LongAnswer("DeformTrack", engine, context, std::move(caller)),
        cancel_(CancelTokenOf(context)) {}

 private:
  // The request counts for as long as the track runs.
  void Received() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) override {
    auto room = engine_.derived.ReserveForRequest(caller_, request_.SpaceUsedLong());
    if (!room) {
      end_ = std::move(room.error());
      return;
    }
    request_room_ = *std::move(room);
    working_ =
        engine_.jobs.TryPost([self = Self<TrackReactor>()] { self->RunPrepare(); }, TurnOf(0));
    if (!working_) end_ = app::Overloaded();
  }

  // Every track has its own turn among the calls of its owner.
  runtime::Share TurnOf(double seconds) const {
    return {caller_.owner, reinterpret_cast<std::uintptr_t>(this), seconds};
  }

  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) override {
    if (finished_) return;
    if (!writing_ && !ready_.empty() && !cancelled_) {
      outgoing_ = std::move(ready_.front());
      ready_.pop_front();
      ++written_;
      Write(outgoing_);
    }
    if (prepared_ && !working_ && ready_.empty() && !end_ && !cancelled_ &&
        next_frame_ < request_.frames_size()) {
      waiting_ = {};
      working_ = engine_.jobs.Continue([self = Self<TrackReactor>()] { self->RunFrames(); },
                                       TurnOf(frames_seconds_));
      if (!working_) end_ = app::Overloaded();
    }
    if (Receiving()) return;
    if (!working_ && !writing_ && (cancelled_ || ready_.empty())) FinishCall();
  }

  std::string LogTail() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) override {
    return fmt::format(" frames={}/{}", written_, request_.frames_size());
  }

  // The jobs, without mutex_.

  void RunPrepare() {
    const Status prepared = OrOutOfMemory([this] { return Prepare(); });
    const MutexLock lock(&mutex_);
    prepared_ = prepared.has_value();
    if (!prepared && !end_) end_ = prepared.error();
    working_ = false;
    Pump();
  }

  void RunFrames() {
    auto frames = OrOutOfMemory([this] { return NextFrames(); });
    const MutexLock lock(&mutex_);
    if (frames) {
      next_frame_ += static_cast<int>(frames->size());
      for (v1::DeformTrackResponse& frame : *frames) ready_.push_back(std::move(frame));
    } else if (!end_) {
      end_ = std::move(frames.error());
    }
    working_ = false;
    Pump();
  }

  Status Prepare() {
    TRY(const auto session, engine_.sessions.Use(caller_.owner, request_.session_id()));
    TRY(auto entry,
        app::WarmHandleSet(engine_, caller_, *session, request_.handle_set_id(), cancel_));
    TRY(options_, FromWire(request_.options(), engine_.limits, *entry.handles->mesh()));
    const auto count = static_cast<std::size_t>(request_.frames_size());
    const std::size_t limit = engine_.limits.max_track_frames;
    if (count > limit) {
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("The track has {} frames, more than max_track_frames of {}.",
                                    count, limit))
                      .Field("frames")
                      .Detail("count", count)
                      .Detail("quota", "max_track_frames")
                      .Detail("limit", limit));
    }
    const std::vector<std::string_view> ids(request_.handle_ids().begin(),
                                            request_.handle_ids().end());
    TRY(order_, app::CompleteOrder(*entry.handles, ids));
    for (std::size_t i = 0; i < count; ++i) {
      if (auto targets = TargetsOf(i); !targets) return Fail(std::move(targets.error()));
      CHECK_OK(cancel_.Check());
    }
    TRY(live_room_, engine_.derived.Reserve(
                        caller_, app::LiveSet::BytesOf(*entry.handles, options_.deform, kLanes) +
                                     options_.bytes()));
    frames_seconds_ = kLanes * EstimateFrame(*entry.handles, options_.deform).seconds();
    live_.emplace(std::move(entry), kLanes);
    return {};
  }

  Result<std::vector<Target>> TargetsOf(std::size_t frame) const {
    return FromWire(request_, frame, order_);
  }

  // The next kLanes frames, or only the next one when they fail together: the frames before a bad
  // one are answered, and the fault names the one that it is.
  Result<std::vector<v1::DeformTrackResponse>> NextFrames() {
    CHECK_OK(cancel_.Check());
    const auto left = static_cast<std::size_t>(request_.frames_size() - next_frame_);
    auto frames = Solve(std::min(kLanes, left));
    if (!frames && left > 1) frames = Solve(1);
    return frames;
  }

  Result<std::vector<v1::DeformTrackResponse>> Solve(std::size_t count) {
    const double queue_micros = waiting_.Micros();
    const runtime::WallTimer working;
    const auto first = static_cast<std::size_t>(next_frame_);
    std::array<std::vector<Target>, kLanes> targets;
    std::array<std::span<const Target>, kLanes> views;
    std::array<ShapeQuality, kLanes> qualities;
    for (std::size_t i = 0; i < count; ++i) {
      TRY(targets[i], TargetsOf(first + i));
      views[i] = targets[i];
    }
    auto moved = live_->MoveMany(std::span(views).first(count), options_.deform, qualities, first,
                                 engine_.metrics, cancel_);
    if (!moved) return Fail(AtFrame(std::move(moved.error()), first));
    std::vector<v1::DeformTrackResponse> responses(count);
    for (std::size_t i = 0; i < count; ++i) {
      v1::Shape& shape = *responses[i].mutable_shape();
      auto good =
          ToWire(*live_, qualities[i], options_, {}, {}, {queue_micros, working, count}, &shape, i);
      if (!good) return Fail(AtFrame(std::move(good.error()), first + i));
      shape.set_sequence(first + i);
    }
    if (first == 0) Append(options_.vertices, responses.front().mutable_vertices());
    return responses;
  }

  static Fault AtFrame(Fault fault, std::size_t index) {
    fault.message = fmt::format("frames[{}]: {}", index, fault.message);
    return fault.Detail("frame", index).Field(fmt::format("frames[{}]", index));
  }

  const CancelToken cancel_;

  // The running job's own; when none runs, of whoever holds mutex_.
  ShapeOptions options_;
  std::vector<std::size_t> order_;  // of each column in the set
  std::optional<app::LiveSet> live_;
  app::DerivedCache::Reservation live_room_;
  double frames_seconds_ = 0;  // that a job is expected to take
  runtime::WallTimer waiting_;
  int next_frame_ = 0;

  app::DerivedCache::Reservation request_room_ ABSL_GUARDED_BY(mutex_);
  bool prepared_ ABSL_GUARDED_BY(mutex_) = false;
  bool working_ ABSL_GUARDED_BY(mutex_) = false;
  std::deque<v1::DeformTrackResponse> ready_ ABSL_GUARDED_BY(mutex_);  // at most kLanes
  v1::DeformTrackResponse outgoing_ ABSL_GUARDED_BY(mutex_);           // gRPC's while writing_
  int written_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace

grpc::ServerBidiReactor<v1::DeformTrackRequest, v1::DeformTrackResponse>* DeformTrack(
    app::Engine& engine, const Identity& identity, grpc::CallbackServerContext* context) {
  return BeginLongAnswer<TrackReactor>(engine, identity, context);
}

}  // namespace arap::rpc
