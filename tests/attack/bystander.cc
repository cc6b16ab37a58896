#include "tests/attack/bystander.h"

#include <algorithm>
#include <utility>

#include <poll.h>

#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"
#include "tests/system/wire/http_get.h"

namespace arap::attack {
namespace {

using std::chrono::milliseconds;
using Stub = v1::DeformationService::Stub;

constexpr int kSize = 40;  // squares along a side of the mesh
constexpr milliseconds kFramePeriod{33};
constexpr milliseconds kJobPeriod{200};
constexpr milliseconds kLookPeriod{500};
constexpr milliseconds kStreamLife{1'000};
constexpr milliseconds kPatience{10'000};     // of each call
constexpr milliseconds kLookPatience{2'000};  // of those that ask whether the server serves

const char* NameOf(grpc::StatusCode code) {
  switch (code) {
    case grpc::CANCELLED:
      return "CANCELLED";
    case grpc::DEADLINE_EXCEEDED:
      return "DEADLINE_EXCEEDED";
    case grpc::NOT_FOUND:
      return "NOT_FOUND";
    case grpc::RESOURCE_EXHAUSTED:
      return "RESOURCE_EXHAUSTED";
    case grpc::UNAVAILABLE:
      return "UNAVAILABLE";
    case grpc::UNAUTHENTICATED:
      return "UNAUTHENTICATED";
    case grpc::INTERNAL:
      return "INTERNAL";
    default:
      return "another status";
  }
}

std::vector<v1::Handle> Handles(std::uint32_t count) {
  std::vector<v1::Handle> handles;
  const std::uint32_t vertices = (kSize + 1) * (kSize + 1);
  for (std::uint32_t i = 0; i < count; ++i) {
    handles.push_back(wire::VertexHandle("h" + std::to_string(i), i * (vertices / count)));
  }
  return handles;
}

}  // namespace

Bystander::Bystander(const std::string& address, const std::string& admin, const std::string& token)
    : address_(address),
      admin_(admin),
      client_(address, token),
      surface_(wire::RequestFor(testing::SphereCap(12, 24, 1.2))) {
  surface_.set_surface_key("kept");
  good_ = SetUp();
  if (!good_) return;
  threads_.emplace_back("the bystander's drag", [this] { Drag(); });
  threads_.emplace_back("the bystander's compilations", [this] { Compile(); });
  threads_.emplace_back("the bystander's flattenings", [this] { Flatten(); });
  threads_.emplace_back("the bystander's looks", [this] { Look(); });
}

Bystander::~Bystander() { stop_ = true; }

bool Bystander::SetUp() {
  v1::FlattenResponse response;
  grpc::ClientContext context;
  fault::SetDeadline(context, kPatience);
  return client_.CreateSession("b").ok() &&
         client_.Register("b", "m", wire::Grid(kSize, kSize)).ok() &&
         client_.Compile("b", "m", "drag", Handles(4)).ok() &&
         client_.flattening().Flatten(&context, surface_, &response).ok();
}

Seen Bystander::Take() {
  const MutexLock lock(&mutex_);
  Seen seen = std::exchange(seen_, {});
  std::vector<double>* const times[] = {&seen.frames, &seen.compiles, &seen.flattens};
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    if (!since_[kind]) continue;
    const std::chrono::duration<double, std::milli> took = Clock::now() - *since_[kind];
    // What has just begun says nothing.
    if (took.count() > Percentile99(*times[kind])) times[kind]->push_back(took.count());
  }
  return seen;
}

void Bystander::Begin(Kind kind) {
  const MutexLock lock(&mutex_);
  since_[kind] = Clock::now();
}

void Bystander::End(Kind kind, const char* what, const grpc::Status& status) {
  const MutexLock lock(&mutex_);
  const std::chrono::duration<double, std::milli> took = Clock::now() - *since_[kind];
  since_[kind].reset();
  if (stop_) return;
  if (!status.ok()) {
    ++seen_.failures[std::string(what) + " " + NameOf(status.error_code())];
    return;
  }
  std::vector<double>* const times[] = {&seen_.frames, &seen_.compiles, &seen_.flattens};
  times[kind]->push_back(took.count());
}

bool Bystander::Until(Clock::time_point time) const {
  while (!stop_ && Clock::now() < time) {
    const auto left = std::chrono::ceil<milliseconds>(time - Clock::now());
    poll(nullptr, 0, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 50)));
  }
  return !stop_;
}

void Bystander::Drag() {
  while (!stop_) {
    const auto end = Clock::now() + kStreamLife;
    if (!DragOnce(end)) Until(end);
  }
}

bool Bystander::DragOnce(Clock::time_point end) {
  grpc::ClientContext context;
  fault::SetDeadline(context, kPatience);
  const auto stream = client_.deformation().StreamDeform(&context);
  v1::StreamDeformRequest request;
  request.mutable_open()->set_session_id("b");
  request.mutable_open()->set_handle_set_id("drag");
  request.mutable_open()->set_delivery(v1::DELIVERY_LATEST);
  v1::StreamDeformResponse response;
  Begin(kFrame);
  if (!stream->Write(request) || !stream->Read(&response)) {
    End(kFrame, "open", stream->Finish());
    return false;
  }
  {
    const MutexLock lock(&mutex_);
    since_[kFrame].reset();  // opening is no frame
  }
  std::uint64_t sequence = 0;
  for (auto next = Clock::now(); next < end; next += kFramePeriod) {
    if (!Until(next)) break;
    v1::HandleUpdate& update = *request.mutable_update();
    update.set_sequence(++sequence);
    if (update.targets_size() == 0) update.add_targets()->set_handle_id("h3");
    update.mutable_targets(0)->set_x(kSize + static_cast<double>(sequence % 7));
    update.mutable_targets(0)->set_y(kSize);
    Begin(kFrame);
    if (!stream->Write(request) || !stream->Read(&response)) {
      End(kFrame, "frame", stream->Finish());
      return false;
    }
    End(kFrame, "frame",
        response.has_shape()
            ? grpc::Status()
            : grpc::Status(static_cast<grpc::StatusCode>(response.error().status().code()), ""));
  }
  stream->WritesDone();
  while (stream->Read(&response)) {
  }
  static_cast<void>(stream->Finish());
  return true;
}

void Bystander::Compile() {
  const std::vector<v1::Handle> handles = Handles(12);
  int round = 0;
  for (auto next = Clock::now(); Until(next); next = std::max(next + kJobPeriod, Clock::now())) {
    v1::CompileHandlesRequest request;
    request.set_session_id("b");
    request.set_mesh_id("m");
    request.set_handle_set_id("c" + std::to_string(++round));
    request.mutable_handles()->Assign(handles.begin(), handles.end());
    // Other handles every time, or there is nothing to be done.
    request.mutable_handles(0)->set_weight(1 + 0.001 * (round % 1'000));
    v1::CompileHandlesResponse response;
    grpc::ClientContext context;
    fault::SetDeadline(context, kPatience);
    Begin(kCompile);
    End(kCompile, "compile", client_.deformation().CompileHandles(&context, request, &response));
    v1::DeleteHandleSetRequest old;
    old.set_session_id("b");
    old.set_handle_set_id(request.handle_set_id());
    v1::DeleteHandleSetResponse ignored;
    static_cast<void>(client_.Call(&Stub::DeleteHandleSet, old, &ignored));
  }
}

void Bystander::Flatten() {
  for (auto next = Clock::now(); Until(next); next = std::max(next + kJobPeriod, Clock::now())) {
    v1::FlattenResponse response;
    grpc::ClientContext context;
    fault::SetDeadline(context, kPatience);
    Begin(kFlatten);
    const grpc::Status status = client_.flattening().Flatten(&context, surface_, &response);
    End(kFlatten, "flatten", status);
    if (!status.ok() || response.surface_cached()) continue;
    const MutexLock lock(&mutex_);
    ++seen_.surfaces_lost;
  }
}

void Bystander::Look() {
  for (auto next = Clock::now(); Until(next); next = std::max(next + kLookPeriod, Clock::now())) {
    const bool ready = wire::HttpGet(admin_, "/readyz").status == 200;
    fault::FaultClient fresh(address_);
    grpc::ClientContext context;
    fault::SetDeadline(context, kLookPatience);
    v1::GetServerInfoResponse response;
    const bool serves = fresh.server().GetServerInfo(&context, {}, &response).ok();
    if (stop_) break;
    const MutexLock lock(&mutex_);
    ++seen_.looks;
    if (ready != serves) ++seen_.lies;
    if (!serves) ++seen_.failures["new connection"];
  }
}

}  // namespace arap::attack
