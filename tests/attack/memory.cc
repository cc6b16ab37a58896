// Attacks on memory that belongs to nobody.
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/attack/attacker.h"

namespace arap::attack {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kPatience{60};

// Sets of a thousand handles on 40,000 vertices: rows × vertices of each.
void HandleRows(Attacker& attacker) {
  Mallory mallory(attacker, 200);
  const auto handles = mallory.Handles(1'000);
  attacker.Begin();
  std::atomic<int> next = 0;
  attacker.Loop(
      2, [&](int) { mallory.Compile("set" + std::to_string(next++ % 60), handles, kPatience); });
}

// Streams that each add a hundred handles to what they drag.
void StreamHandles(Attacker& attacker) {
  Mallory mallory(attacker, 200);
  mallory.Compile("h", mallory.Handles(4));
  struct Open {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderWriter<v1::StreamDeformRequest, v1::StreamDeformResponse>>
        stream;
  };
  std::vector<std::vector<std::unique_ptr<Open>>> held(2);
  attacker.Begin();
  attacker.Loop(2, [&](int part) {
    auto open = std::make_unique<Open>();
    fault::SetDeadline(open->context, kPatience);
    open->stream = mallory.client().deformation().StreamDeform(&open->context);
    v1::StreamDeformRequest request;
    request.mutable_open()->set_session_id("s");
    request.mutable_open()->set_handle_set_id("h");
    request.mutable_open()->set_delivery(v1::DELIVERY_EVERY);
    v1::StreamDeformResponse response;
    if (!open->stream->Write(request) || !open->stream->Read(&response)) {
      return attacker.Count(open->stream->Finish());
    }
    v1::HandleEdit& edit = *request.mutable_edit();
    edit.set_sequence(1);
    for (std::uint32_t i = 0; i < 100; ++i) {
      *edit.add_add() = wire::VertexHandle("e" + std::to_string(i), 397 * i + 11);
    }
    const bool added =
        open->stream->Write(request) && open->stream->Read(&response) && !response.has_error();
    attacker.Count(added ? grpc::Status() : grpc::Status(grpc::RESOURCE_EXHAUSTED, ""),
                   request.ByteSizeLong());
    held[static_cast<std::size_t>(part)].push_back(std::move(open));
  });
}

// A track of many frames, read or not.
std::unique_ptr<grpc::ClientReader<v1::DeformTrackResponse>> Track(Mallory& mallory, int frames,
                                                                   grpc::ClientContext& context) {
  v1::DeformTrackRequest request;
  request.set_session_id(mallory.session());
  request.set_handle_set_id("h");
  request.mutable_options()->set_float64(true);
  for (int i = 0; i < 4; ++i) request.add_handle_ids("h" + std::to_string(i));
  for (int i = 0; i < frames; ++i) {
    v1::TrackFrame& frame = *request.add_frames();
    for (int k = 0; k < 8; ++k) frame.add_positions(i % 10 + k);
  }
  fault::SetDeadline(context, kPatience);
  return mallory.client().deformation().DeformTrack(&context, request);
}

void UnreadTracks(Attacker& attacker, int count, int frames, int size) {
  Mallory mallory(attacker, size);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::ClientReader<v1::DeformTrackResponse>>> readers;
  for (int i = 0; i < count; ++i) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    readers.push_back(Track(mallory, frames, *contexts.back()));
    attacker.Spend(1);
  }
  attacker.Hold();
}

void LargeUnreadTracks(Attacker& attacker) { UnreadTracks(attacker, 12, 10'000, 200); }

// Sessions with sets of a thousand handles whose names are as long as they may be.
void SessionRecords(Attacker& attacker) {
  attacker.Begin();
  std::atomic<int> next = 0;
  attacker.Loop(2, [&](int) {
    const int number = next++;
    fault::FaultClient client(attacker.address(), attacker.token());
    const std::string session = "r" + std::to_string(number);
    attacker.Count(client.CreateSession(session));
    attacker.Count(client.Register(session, "m", wire::Grid(20, 20)));
    std::vector<v1::Handle> handles;
    for (std::uint32_t i = 0; i < 1'000; ++i) {
      handles.push_back(
          wire::VertexHandle(std::string(56, 'n') + std::to_string(10'000 + i), i % 441));
    }
    for (int set = 0; set < 60; ++set) {
      attacker.Count(client.Compile(session, "m", "set" + std::to_string(set), handles), 80'000);
    }
  });
}

// Streams on a large mesh that are sent updates and never read.
void UnreadStreams(Attacker& attacker) {
  Mallory mallory(attacker, 200);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  attacker.Loop(100, [&](int) {
    grpc::ClientContext context;
    fault::SetDeadline(context, kPatience);
    const auto stream = mallory.client().deformation().StreamDeform(&context);
    v1::StreamDeformRequest request;
    request.mutable_open()->set_session_id("s");
    request.mutable_open()->set_handle_set_id("h");
    request.mutable_open()->set_delivery(v1::DELIVERY_EVERY);
    request.mutable_open()->mutable_options()->set_float64(true);
    for (std::uint64_t sequence = 1; stream->Write(request); ++sequence) {
      attacker.Spend(1);
      request.mutable_update()->set_sequence(sequence);
      request.mutable_update()->clear_targets();
      *request.mutable_update()->add_targets() =
          wire::TargetAt("h0", static_cast<double>(sequence % 9), 0);
    }
    attacker.Count(stream->Finish());
  });
}

// 48 uploads of 18 MB at once, which all wait for their turn.
void QueuedUploads(Attacker& attacker) {
  std::vector<std::unique_ptr<Mallory>> owners;
  owners.push_back(std::make_unique<Mallory>(attacker, 2));
  v1::RegisterMeshRequest request;
  request.set_session_id("s");
  *request.mutable_mesh() = wire::Grid(800, 800);
  attacker.Begin();
  attacker.Loop(48, [&](int i) {
    v1::RegisterMeshRequest mine = request;
    mine.set_mesh_id("u" + std::to_string(i));
    mine.mutable_mesh()->set_vertices(0, -1e-3 * i);
    attacker.Call(owners.front()->client().deformation(),
                  &v1::DeformationService::Stub::RegisterMesh, mine, kPatience);
  });
}

}  // namespace

std::vector<Attack> AttacksOnMemory() {
  return {
      {"handle-rows", "sets of 1,000 handles on 40,000 vertices", HandleRows},
      {"stream-handles", "streams that add 100 handles each", StreamHandles},
      {"unread-tracks", "12 tracks of 10,000 frames that nobody reads", LargeUnreadTracks},
      {"unread-streams", "100 streams on 40,000 vertices that nobody reads", UnreadStreams},
      {"session-records", "sessions full of sets with 1,000 long names", SessionRecords},
      {"queued-uploads", "48 uploads of 18 MB at once", QueuedUploads},
  };
}

}  // namespace arap::attack
