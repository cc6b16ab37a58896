// Attacks that take more than a share: nothing but allowed calls, and many of them.
#include <memory>
#include <string>
#include <vector>

#include <poll.h>

#include "tests/attack/attacker.h"
#include "tests/support/surfaces.h"
#include "tests/system/wire/flatten_fixture.h"

namespace arap::attack {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kPatience{60};

struct OpenedStream {
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReaderWriter<v1::StreamDeformRequest, v1::StreamDeformResponse>>
      stream;
  bool open = false;
};

std::unique_ptr<OpenedStream> OpenStream(Attacker& attacker, Mallory& mallory,
                                         std::uint32_t refine) {
  auto opened = std::make_unique<OpenedStream>();
  fault::SetDeadline(opened->context, kPatience);
  opened->stream = mallory.client().deformation().StreamDeform(&opened->context);
  v1::StreamDeformRequest request;
  request.mutable_open()->set_session_id("s");
  request.mutable_open()->set_handle_set_id("h");
  request.mutable_open()->set_delivery(v1::DELIVERY_LATEST);
  request.mutable_open()->mutable_options()->set_refine(refine);
  v1::StreamDeformResponse response;
  opened->open = opened->stream->Write(request) && opened->stream->Read(&response);
  attacker.Count(opened->open ? grpc::Status() : opened->stream->Finish());
  return opened;
}

// Two streams that want every frame as fast as it comes, of 10,000 vertices refined 20 times.
void GreedyStreams(Attacker& attacker) {
  Mallory mallory(attacker, 100);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  attacker.Loop(2, [&](int) {
    const auto opened = OpenStream(attacker, mallory, 20);
    if (!opened->open) {
      static_cast<void>(poll(nullptr, 0, 100));
      return;
    }
    v1::StreamDeformRequest request;
    v1::HandleUpdate& update = *request.mutable_update();
    *update.add_targets() = wire::TargetAt("h0", 0, 0);
    v1::StreamDeformResponse response;
    for (std::uint64_t sequence = 1;; ++sequence) {
      update.set_sequence(sequence);
      update.mutable_targets(0)->set_x(static_cast<double>(sequence % 9));
      if (!opened->stream->Write(request) || !opened->stream->Read(&response)) break;
      attacker.Spend(1);
    }
  });
}

// Streams with a thousand refinements that never send a frame.
void IdleDeepStreams(Attacker& attacker) {
  Mallory mallory(attacker, 100);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  std::vector<std::unique_ptr<OpenedStream>> held;
  held.reserve(200);
  for (int i = 0; i < 200; ++i) held.push_back(OpenStream(attacker, mallory, 1'000));
  attacker.Hold();
}

void UnaryLoop(Attacker& attacker) {
  Mallory mallory(attacker, 100);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  attacker.Loop(8, [&](int) { mallory.Deform("h", 4, 20, kPatience); });
}

// 256 tracks at once, read as they come.
void ManyTracks(Attacker& attacker) {
  Mallory mallory(attacker, 60);
  mallory.Compile("h", mallory.Handles(4));
  attacker.Begin();
  attacker.Loop(250, [&](int) {
    v1::DeformTrackRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    for (int i = 0; i < 4; ++i) request.add_handle_ids("h" + std::to_string(i));
    for (int i = 0; i < 200; ++i) {
      v1::TrackFrame& frame = *request.add_frames();
      for (int k = 0; k < 8; ++k) frame.add_positions(i % 10 + k);
    }
    grpc::ClientContext context;
    fault::SetDeadline(context, kPatience);
    const auto reader = mallory.client().deformation().DeformTrack(&context, request);
    v1::DeformTrackResponse response;
    while (reader->Read(&response)) {
    }
    attacker.Count(reader->Finish());
  });
}

// 64 uploads at once of meshes of 40,000 vertices, each another one.
void ManyUploads(Attacker& attacker) {
  Mallory mallory(attacker, 2);
  v1::RegisterMeshRequest request;
  request.set_session_id("s");
  *request.mutable_mesh() = wire::Grid(200, 200);
  attacker.Begin();
  std::atomic<int> number = 0;
  attacker.Loop(64, [&](int i) {
    v1::RegisterMeshRequest mine = request;
    mine.set_mesh_id("m" + std::to_string(i % 14));
    mine.mutable_mesh()->set_vertices(0, -1e-6 * ++number);
    attacker.Call(mallory.client().deformation(), &v1::DeformationService::Stub::RegisterMesh, mine,
                  kPatience);
  });
}

void BigFlattens(Attacker& attacker) {
  const v1::FlattenRequest request = wire::RequestFor(testing::SphereCap(200, 250, 1.5));
  fault::FaultClient client(attacker.address(), attacker.token());
  attacker.Begin();
  attacker.Loop(16, [&](int) {
    attacker.Call(client.flattening(), &v1::FlatteningService::Stub::Flatten, request, kPatience);
  });
}

// A session with 60 sets of 500 handles, and edits of them without a break.
void LargeSession(Attacker& attacker) {
  Mallory mallory(attacker, 30);
  const auto handles = mallory.Handles(500);
  for (int i = 0; i < 60; ++i) mallory.Compile("set" + std::to_string(i), handles);
  attacker.Begin();
  attacker.Loop(4, [&](int i) {
    v1::EditHandlesRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("set" + std::to_string(i));
    request.add_remove("h7");
    v1::Handle handle = handles[7];
    handle.set_weight(1 + 0.1 * i);
    *request.add_add() = handle;
    attacker.Call(mallory.client().deformation(), &v1::DeformationService::Stub::EditHandles,
                  request, kPatience);
  });
}

// Single triangles under keys of their own, which take the places of what others have kept.
void KeptTriangles(Attacker& attacker) {
  fault::FaultClient client(attacker.address(), attacker.token());
  attacker.Begin();
  std::atomic<int> number = 0;
  attacker.Loop(2, [&](int) {
    const int mine = number++;
    v1::FlattenRequest request =
        wire::RequestFor({{{0, 0, 0}, {1, 0, 0}, {0, 1, 1e-6 * mine}}, {{0, 1, 2}}});
    request.set_surface_key("k" + std::to_string(mine));
    attacker.Call(client.flattening(), &v1::FlatteningService::Stub::Flatten, request, kPatience);
  });
}

// Registrations and compilations whose callers are gone before they end.
void AbandonedJobs(Attacker& attacker) {
  Mallory mallory(attacker, 200);
  const auto handles = mallory.Handles(300);
  v1::RegisterMeshRequest request;
  request.set_session_id("s");
  *request.mutable_mesh() = wire::Grid(200, 200);
  attacker.Begin();
  std::atomic<int> number = 0;
  attacker.Loop(16, [&](int i) {
    const int mine = number++;
    if (i % 2 == 0) {
      mallory.Compile("gone" + std::to_string(mine), handles, milliseconds(20));
      return;
    }
    v1::RegisterMeshRequest again = request;
    again.set_mesh_id("gone" + std::to_string(mine));
    again.mutable_mesh()->set_vertices(0, -1e-6 * mine);
    attacker.Call(mallory.client().deformation(), &v1::DeformationService::Stub::RegisterMesh,
                  again, milliseconds(50));
  });
}

// A thousand sessions with as many labels as they may have, listed again and again.
void LongLists(Attacker& attacker) {
  fault::FaultClient client(attacker.address(), attacker.token());
  for (int i = 0; i < 900; ++i) {
    v1::CreateSessionRequest request;
    request.set_session_id("l" + std::to_string(i));
    for (int k = 0; k < 16; ++k) {
      (*request.mutable_labels())["label" + std::to_string(k)] = std::string(60, 'v');
    }
    v1::CreateSessionResponse response;
    attacker.Count(client.Call(&v1::DeformationService::Stub::CreateSession, request, &response));
  }
  attacker.Begin();
  attacker.Loop(16, [&](int) {
    v1::ListSessionsRequest request;
    request.set_page_size(1'000);
    v1::ListSessionsResponse response;
    attacker.Count(client.Call(&v1::DeformationService::Stub::ListSessions, request, &response));
  });
}

// Sessions made and deleted, and listed, by many at once.
void SessionChurn(Attacker& attacker) {
  fault::FaultClient client(attacker.address(), attacker.token());
  attacker.Begin();
  std::atomic<int> number = 0;
  attacker.Loop(16, [&](int) {
    const std::string id = "c" + std::to_string(number++);
    attacker.Count(client.CreateSession(id));
    v1::ListSessionsResponse response;
    attacker.Count(client.Call(&v1::DeformationService::Stub::ListSessions,
                               v1::ListSessionsRequest(), &response));
    if (number % 2 == 0) attacker.Count(client.DeleteSession(id));
  });
}

}  // namespace

std::vector<Attack> AttacksOnFairness() {
  return {
      {"greedy-streams", "two streams that take every frame they get", GreedyStreams},
      {"idle-deep-streams", "200 streams with a thousand refinements and no frame",
       IdleDeepStreams},
      {"unary-loop", "eight callers of Deform without a break", UnaryLoop},
      {"many-tracks", "250 tracks at once", ManyTracks},
      {"many-uploads", "64 uploads of 40,000 vertices at once", ManyUploads, 1'024},
      {"big-flattens", "16 flattenings of 100,000 triangles at once", BigFlattens, 2'048},
      {"large-session", "a session of 60 large sets, edited without a break", LargeSession},
      {"kept-triangles", "single triangles under ever new keys", KeptTriangles},
      {"abandoned-jobs", "jobs whose 16 callers are gone before they end", AbandonedJobs, 1'024},
      {"long-lists", "900 sessions with labels, listed by 16 callers", LongLists},
      {"session-churn", "sessions made, listed and deleted by 16 callers", SessionChurn},
  };
}

}  // namespace arap::attack
