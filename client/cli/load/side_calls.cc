#include "client/cli/load/side_calls.h"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "arap/v1/deformation_service.grpc.pb.h"
#include "arap/v1/flattening_service.grpc.pb.h"
#include "client/cli/load/pacer.h"
#include "client/src/answers.h"
#include "client/src/calls.h"
#include "core/base/try.h"
#include "proto/convert/deform.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"
#include "proto/convert/status.h"

namespace arap::cli {
namespace {

void Prepare(const LoadSession& session, grpc::ClientContext& context) {
  client::internal::CallHeaders(session.id).AddTo(context);
  context.set_deadline(std::chrono::system_clock::now() + client::kWorkLimit);
}

// What a call needs until its answer is there.
template <class Request, class Response>
struct Pending {
  std::shared_ptr<client::internal::Channel> channel;
  grpc::ClientContext context;
  Request request;
  Response response;
};

}  // namespace

SideCalls::SideCalls(const LoadScene& scene, std::uint64_t seed, Gate& gate)
    : scene_(scene), seed_(seed), gate_(gate) {
  client::internal::ToWire(scene.surface, client::FlattenQuery{}, &flatten_);
  flatten_.set_max_response_bytes(client::internal::kMaxMessageBytes);
  convert::ToWire(scene.mesh, register_.mutable_mesh());
  convert::ToWire(EnergyOptions{}, register_.mutable_energy());
}

void SideCalls::Enter(grpc::ClientContext& context) {
  gate_.Enter();
  const MutexLock lock(&mutex_);
  under_way_.insert(&context);
}

void SideCalls::Leave(grpc::ClientContext& context) {
  const MutexLock lock(&mutex_);
  under_way_.erase(&context);
}

void SideCalls::CancelAll() {
  const MutexLock lock(&mutex_);
  for (grpc::ClientContext* const context : under_way_) context->TryCancel();
}

void SideCalls::StartFlatten(const LoadSession& session, Done done, Verifier::Told verified) {
  auto* const call = new Pending<v1::FlattenRequest, v1::FlattenResponse>;
  call->channel = session.connection->Get().first;
  Prepare(session, call->context);
  Enter(call->context);
  call->channel->flattening().async()->Flatten(
      &call->context, &flatten_, &call->response,
      [this, call, done = std::move(done),
       verified = std::move(verified)](const grpc::Status& status) {
        const Moment now = Now();
        if (!status.ok()) {
          done(now, Fail(convert::FaultOf(status)));
        } else if (auto flat = client::internal::FromWire(call->response, scene_.surface, {})) {
          if (verified) verifier_->AskFlat(std::move(flat->flat.uv), verified);
          done(now, ServerTimes{flat->queue_micros, flat->solve_micros});
        } else {
          done(now, Fail(std::move(flat.error())));
        }
        Leave(call->context);
        delete call;
        gate_.Leave();
      });
}

void SideCalls::StartRegister(const LoadSession& session, std::uint64_t number, Done done,
                              Verifier::Told verified) {
  auto* const call = new Pending<v1::RegisterMeshRequest, v1::RegisterMeshResponse>;
  call->channel = session.connection->Get().first;
  Prepare(session, call->context);
  call->request = register_;
  call->request.set_session_id(session.id);
  // Another size is another mesh.
  const double scale = 1 + std::ldexp(static_cast<double>((number + seed_) % (1U << 20U)), -21);
  for (double& x : *call->request.mutable_mesh()->mutable_vertices()) x *= scale;
  Enter(call->context);
  call->channel->deformation().async()->RegisterMesh(
      &call->context, &call->request, &call->response,
      [this, &session, call, scale, done = std::move(done),
       verified = std::move(verified)](const grpc::Status& status) {
        const Moment now = Now();
        const v1::RegisterMeshResponse& response = call->response;
        if (!status.ok()) {
          done(now, Fail(convert::FaultOf(status)));
        } else if (auto mesh = client::internal::FromWire(response.mesh(), {}, &scene_.mesh)) {
          if (verified) verifier_->AskMesh(scale, *mesh, verified);
          done(now, ServerTimes{convert::Micros(response.queue_time()),
                                convert::Micros(response.solve_time())});
          Forget(session, mesh->id);
        } else {
          done(now, Fail(std::move(mesh.error())));
        }
        Leave(call->context);
        delete call;
        gate_.Leave();
      });
}

void SideCalls::Forget(const LoadSession& session, const std::string& mesh_id) {
  // The streams need that one.
  if (mesh_id == session.mesh_id) return;
  auto* const call = new Pending<v1::DeleteMeshRequest, v1::DeleteMeshResponse>;
  call->channel = session.connection->Get().first;
  Prepare(session, call->context);
  call->request.set_session_id(session.id);
  call->request.set_mesh_id(mesh_id);
  Enter(call->context);
  call->channel->deformation().async()->DeleteMesh(&call->context, &call->request, &call->response,
                                                   [this, call](const grpc::Status& /*status*/) {
                                                     Leave(call->context);
                                                     delete call;
                                                     gate_.Leave();
                                                   });
}

// A track of some frames; it goes when it is over.
class SideCalls::Bake final : public grpc::ClientReadReactor<v1::DeformTrackResponse> {
 public:
  Bake(SideCalls& calls, const LoadSession& session, std::uint64_t number, Done done,
       Verifier::Told verified)
      : calls_(calls),
        scene_(calls.scene_),
        number_(number),
        done_(std::move(done)),
        verified_(std::move(verified)),
        channel_(session.connection->Get().first) {
    Prepare(session, context_);
    request_.set_session_id(session.id);
    request_.set_handle_set_id(kLoadSet);
    client::internal::ToWire(options_, request_.mutable_options());
    for (const Handle& handle : scene_.handles) request_.add_handle_ids(handle.id);
    for (std::size_t i = 0; i < kBakedFrames; ++i) {
      std::vector<Target> targets;
      for (const Complex at : TargetsOf(scene_, calls.seed_, number, i)) targets.push_back({at});
      convert::ToWire(targets, request_.add_frames());
    }
    calls_.Enter(context_);
    channel_->deformation().async()->DeformTrack(&context_, &request_, this);
    StartRead(&response_);
    StartCall();
  }
  ~Bake() override = default;

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return;
    if (const Status right = Take(); !right && !bad_) {
      bad_ = right.error();
      context_.TryCancel();
    }
    StartRead(&response_);
  }

  Status Take() {
    if (frames_ >= kBakedFrames) {
      return Fail(
          client::internal::BadAnswer("The server answered more frames than were asked for."));
    }
    const client::internal::MeshSize size{scene_.mesh.vertices.size(),
                                          scene_.mesh.triangles.size()};
    TRY(client::Shape shape, client::internal::FromWire(response_.shape(), {options_, size}));
    if (shape.sequence != frames_) {
      return Fail(client::internal::BadAnswer("The server answered a frame out of its turn."));
    }
    times_.queue_micros += shape.queue_micros;
    times_.solve_micros += shape.solve_micros;
    if (verified_ && frames_ == number_ % kBakedFrames) kept_ = std::move(shape);
    ++frames_;
    return {};
  }

  void OnDone(const grpc::Status& status) override {
    const Moment now = Now();
    if (bad_) {
      done_(now, Fail(*std::move(bad_)));
    } else if (!status.ok()) {
      done_(now, Fail(convert::FaultOf(status)));
    } else if (frames_ < kBakedFrames) {
      done_(now, Fail(client::internal::BadAnswer(
                     fmt::format("The server answered {} frames of {}.", frames_, kBakedFrames))));
    } else {
      if (kept_) {
        Verifier::Pose pose{TargetsOf(scene_, calls_.seed_, number_, number_ % kBakedFrames)};
        calls_.verifier_->AskShape(std::move(pose), *std::move(kept_), verified_);
      }
      done_(now, times_);
    }
    Gate& gate = calls_.gate_;
    calls_.Leave(context_);
    delete this;
    gate.Leave();
  }

  SideCalls& calls_;
  const LoadScene& scene_;
  const std::uint64_t number_;
  const Done done_;
  const Verifier::Told verified_;
  const std::shared_ptr<client::internal::Channel> channel_;
  const client::ShapeOptions options_;
  grpc::ClientContext context_;
  v1::DeformTrackRequest request_;
  v1::DeformTrackResponse response_;
  std::size_t frames_ = 0;
  ServerTimes times_;
  std::optional<client::Shape> kept_;  // to be verified
  std::optional<Fault> bad_;
};

void SideCalls::Start(Operation operation, const LoadSession& session, std::uint64_t number,
                      Done done, Verifier::Told verified) {
  switch (operation) {
    case Operation::kBake:
      new Bake(*this, session, number, std::move(done), std::move(verified));
      return;
    case Operation::kFlatten:
      return StartFlatten(session, std::move(done), std::move(verified));
    case Operation::kRegister:
      return StartRegister(session, number, std::move(done), std::move(verified));
    case Operation::kDrag:
    case Operation::kEdit:
      return;
  }
}

}  // namespace arap::cli
