#include "client/cli/load/echo_load.h"

#include <deque>
#include <optional>
#include <string>
#include <utility>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/echo_service.grpc.pb.h>
#include <grpcpp/grpcpp.h>

#include "client/cli/load/pacer.h"
#include "client/cli/load/wire_call.h"
#include "client/src/calls.h"
#include "core/base/mutex.h"
#include "core/base/try.h"
#include "proto/convert/status.h"

namespace arap::cli {
namespace {

// When echoes count, and when no more are sent.
struct Stretch {
  Moment from{0}, end{0};
};

// One stream. Everything is begun before the call or within a reaction, so it needs no hold.
class EchoStream final : public grpc::ClientBidiReactor<v1::EchoRequest, v1::EchoResponse> {
 public:
  EchoStream(const EchoPlan& plan, const Stretch& stretch, Gate& gate)
      : plan_(plan), stretch_(stretch), gate_(gate) {
    outgoing_.set_payload(std::string(plan.request_bytes, 'e'));
    outgoing_.set_answer_bytes(static_cast<std::uint32_t>(plan.answer_bytes));
  }

  void Begin(const std::shared_ptr<LoadConnection::Channel>& channel) {
    const client::internal::CallHeaders headers{std::string()};
    headers.AddTo(context_);
    stub_ = v1::EchoService::NewStub(std::shared_ptr<grpc::Channel>(channel, &channel->grpc()));
    gate_.Enter();
    stub_->async()->Echo(&context_, this);
    StartRead(&incoming_);
    {
      const MutexLock lock(&mutex_);
      Pump(Now());
    }
    StartCall();
  }

  void Cancel() { context_.TryCancel(); }

  Histogram round_trip() const {
    const MutexLock lock(&mutex_);
    return round_trip_;
  }
  // How it has failed, if it has.
  std::optional<Fault> fault() const {
    const MutexLock lock(&mutex_);
    return fault_;
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return;
    const Moment now = Now();
    {
      const MutexLock lock(&mutex_);
      if (sent_.empty()) return Cancel();  // an answer to nothing
      const Moment sent = sent_.front();
      sent_.pop_front();
      if (sent >= stretch_.from && now <= stretch_.end) round_trip_.Record(MicrosOf(now - sent));
      Pump(now);
    }
    StartRead(&incoming_);
  }

  void OnWriteDone(bool ok) override {
    const MutexLock lock(&mutex_);
    writing_ = false;
    if (ok) Pump(Now());
  }

  // The last of all: it may be gone when the gate is empty.
  void OnDone(const grpc::Status& status) override {
    if (!status.ok()) {
      const MutexLock lock(&mutex_);
      fault_ = convert::FaultOf(status);
    }
    gate_.Leave();
  }

  void Pump(Moment now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (writing_ || ended_) return;
    if (now >= stretch_.end) {
      ended_ = true;
      return StartWritesDone();
    }
    if (sent_.size() >= plan_.window) return;
    sent_.push_back(now);
    writing_ = true;
    StartWrite(&outgoing_);
  }

  const EchoPlan& plan_;
  const Stretch& stretch_;
  Gate& gate_;
  std::unique_ptr<v1::EchoService::Stub> stub_;
  grpc::ClientContext context_;
  // gRPC's while it reads and writes.
  v1::EchoRequest outgoing_;
  v1::EchoResponse incoming_;

  mutable Mutex mutex_;
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  std::deque<Moment> sent_ ABSL_GUARDED_BY(mutex_);
  Histogram round_trip_ ABSL_GUARDED_BY(mutex_);
  std::optional<Fault> fault_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace

void MeasureMessages(std::size_t handles, std::size_t vertices, client::PositionEncoding encoding,
                     EchoPlan& plan) {
  const auto numbers = [](std::size_t points) { return static_cast<int>(2 * points); };
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(1000);
  request.mutable_update()->mutable_positions()->Resize(numbers(handles), 1);
  v1::StreamDeformResponse response;
  v1::Shape& shape = *response.mutable_shape();
  if (encoding == client::PositionEncoding::kFloat32) {
    shape.mutable_positions()->Resize(numbers(vertices), 1);
  } else {
    const bool floats = encoding == client::PositionEncoding::kFloat32Le;
    shape.mutable_packed_positions()->resize((floats ? 8 : 4) * vertices);
    if (!floats) shape.set_scale(1);
    for (int i = 0; i < (floats ? 0 : 2); ++i) shape.add_origin(1);
  }
  shape.set_sequence(1000);
  shape.set_worst_handle_error(1);
  shape.set_worst_handle_id("handle");
  shape.set_energy(1);
  shape.set_mean_stretch(1);
  shape.set_max_stretch(1);
  shape.set_queue_micros(1);
  shape.set_solve_micros(1);
  shape.set_handle_set_revision(1);
  plan.request_bytes = request.ByteSizeLong();
  plan.answer_bytes = response.ByteSizeLong();
}

Result<TransportResults> RunEchoes(const std::vector<std::unique_ptr<LoadConnection>>& connections,
                                   const EchoPlan& plan, const std::stop_token& stop) {
  constexpr Moment kPatience = std::chrono::seconds(10);
  const Moment now = Now();
  const Stretch stretch{now + FromSeconds(plan.seconds / 4),
                        now + FromSeconds(plan.seconds * 1.25)};
  Gate gate;
  std::vector<std::unique_ptr<EchoStream>> streams;
  for (std::size_t i = 0; i < plan.streams; ++i) {
    streams.push_back(std::make_unique<EchoStream>(plan, stretch, gate));
    streams.back()->Begin(connections[i % connections.size()]->Get().first);
  }
  const auto cancel = [&streams] {
    for (const auto& stream : streams) stream->Cancel();
  };
  {
    const std::stop_callback at_stop(stop, cancel);
    const auto until = std::chrono::steady_clock::time_point(stretch.end + kPatience);
    if (!gate.AwaitFewer(1, until)) cancel();
    gate.AwaitEmpty();
  }
  TransportResults results;
  results.seconds = plan.seconds;
  for (const auto& stream : streams) {
    if (const auto fault = stream->fault(); fault && !stop.stop_requested()) return Fail(*fault);
    results.round_trip.Merge(stream->round_trip());
  }
  return results;
}

}  // namespace arap::cli
