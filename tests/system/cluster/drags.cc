#include "tests/system/cluster/drags.h"

#include <array>
#include <cmath>
#include <variant>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "client/cli/sample/samples.h"
#include "tests/system/fault/client.h"

namespace arap::cluster {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kPoses = 16;

}  // namespace

Puppet MakePuppet() {
  Puppet puppet{
      cli::MakeGrid(9, 9), {{"l", client::VertexAnchor{0}}, {"r", client::VertexAnchor{8}}}, {}};
  const auto registered = RegisteredMesh::Register(puppet.mesh, {}).value();
  Deformer deformer(CompiledHandles::Compile(registered, puppet.handles).value());
  for (std::size_t i = 0; i < kPoses; ++i) {
    Pose pose{{{0, 0}, std::polar(9.0, 0.1 * static_cast<double>(i))}, {}};
    const std::array<Target, 2> targets{Target{pose.places[0]}, Target{pose.places[1]}};
    (void)deformer.Update(targets).value();
    const auto shape = deformer.positions();
    pose.shape.assign(shape.begin(), shape.end());
    puppet.poses.push_back(std::move(pose));
  }
  return puppet;
}

Drags::Drags(const std::string& address, const Puppet& puppet, std::size_t count,
             std::chrono::milliseconds period)
    : address_(address), puppet_(puppet), count_(count), period_(period) {
  for (std::size_t i = 0; i < count; ++i) Join([this, i] { Drag(i); });
}

bool Drags::AllMoved(std::chrono::seconds patience) const {
  return fault::Eventually([&] { return moving_ == count_; }, patience);
}

void Drags::Drag(std::size_t number) {
  const client::Client client = client::Client::Connect(address_);
  const client::CallOptions call{.timeout = kPatience, .retry_within = kRetryWithin};
  client::SessionOptions named;
  named.id = "drag-" + std::to_string(number);
  const auto session = client.CreateSession(named, call);
  if (!Answered("CreateSession", session) ||
      !Answered("RegisterMesh", session->RegisterMesh(puppet_.mesh, {}, "m", call)) ||
      !Answered("CompileHandles", session->CompileHandles("h", "m", puppet_.handles, call))) {
    return;
  }
  const auto delivery = number % 2 == 0 ? client::Delivery::kEvery : client::Delivery::kLatest;
  client::StreamOptions options{delivery, {.float64 = true}};
  options.heartbeat = std::chrono::seconds(1);
  options.silence = std::chrono::seconds(10);
  options.resume_within = kPatience;
  auto stream = session->OpenStream("h", options);
  if (!Answered("OpenStream", stream)) return;
  std::uint64_t sequence = 0;
  do {
    if (!Move(*stream, ++sequence)) return;
    if (sequence == 1) ++moving_;
  } while (!StopWithin(period_));
  if (!Move(*stream, ++sequence)) return;
  (void)stream->CloseSending();  // reading tells
  for (;;) {
    const auto event = stream->Read();
    if (!event) return Complain("the end of a stream: " + event.error().message);
    if (!*event) break;
    if (std::holds_alternative<client::Shape>(**event)) Complain("a shape that nobody asked for");
  }
  ++ended_well_;
}

bool Drags::Move(client::DeformStream& stream, std::uint64_t sequence) {
  const auto sent = steady_clock::now();
  bool resumed = false;
  if (!Update(stream, sequence, resumed)) return false;
  if (!resumed) return true;
  const std::chrono::duration<double> waited = steady_clock::now() - sent;
  const std::lock_guard lock(interruptions_mutex_);
  interruptions_.push_back({sent, waited.count()});
  return true;
}

bool Drags::Update(client::DeformStream& stream, std::uint64_t sequence, bool& resumed) {
  const Pose& pose = puppet_.poses[sequence % puppet_.poses.size()];
  client::HandleUpdate update;
  update.sequence = sequence;
  update.positions = pose.places;
  (void)stream.Send(update);  // reading tells
  for (;;) {
    const auto event = stream.Read();
    if (!event || !*event) {
      Complain("a stream: " + (event ? "it ended" : event.error().message));
      return false;
    }
    if (std::holds_alternative<client::Resumed>(**event)) {
      ++resumed_;
      resumed = true;
    }
    if (const auto* error = std::get_if<client::UpdateError>(&**event)) {
      Complain("an update: " + error->fault.message);
      return false;
    }
    const auto* const shape = std::get_if<client::Shape>(&**event);
    if (shape == nullptr) continue;
    ++shapes_;
    if (shape->sequence != sequence) Complain("an answer to another update");
    if (shape->positions != pose.shape) Complain("a wrong shape");
    return true;
  }
}

}  // namespace arap::cluster
