#include "tests/system/fault/soak_load.h"

#include <cmath>
#include <limits>

#include "tests/system/fault/raw_peer.h"

namespace arap::fault {
namespace {

using std::chrono::milliseconds;
using Stub = v1::DeformationService::Stub;

constexpr int kGrid = 40;  // 1,681 vertices
constexpr int kSheet = 16;

// A sheet with a bump; `height` makes it another surface.
v1::SurfaceMesh Sheet(double height) {
  const v1::PlanarMesh planar = wire::Grid(kSheet, kSheet);
  v1::SurfaceMesh mesh;
  for (int v = 0; v < planar.vertices_size() / 2; ++v) {
    const double x = planar.vertices(2 * v), y = planar.vertices(2 * v + 1);
    for (const double number : {x, y, height * std::sin(0.3 * x) * std::cos(0.2 * y)}) {
      mesh.add_vertices(number);
    }
  }
  *mesh.mutable_triangles() = planar.triangles();
  return mesh;
}

bool Flatten(FaultClient& client, testing::Random& random) {
  v1::FlattenRequest request;
  *request.mutable_mesh() = Sheet(0.5 + 0.1 * static_cast<double>(random.Below(20)));
  request.set_method(static_cast<v1::FlattenMethod>(1 + random.Below(5)));
  if (random.Coin()) request.set_surface_key("sheet" + std::to_string(random.Below(4)));
  grpc::ClientContext context;
  SetDeadline(context);
  v1::FlattenResponse response;
  return client.flattening().Flatten(&context, request, &response).ok();
}

// Everything from the beginning to the end of a session.
bool Live(FaultClient& client, testing::Random& random) {
  const std::string session = "short" + std::to_string(random.Below(1u << 30u));
  const int size = 8 + static_cast<int>(random.Below(24));
  bool good = client.CreateSession(session).ok();
  good = good && client.Register(session, "m", wire::Grid(size, size)).ok();
  good = good &&
         client.Compile(session, "m", "h", {wire::VertexHandle("a", 0), wire::VertexHandle("b", 5)})
             .ok();
  good = good &&
         client.Deform(session, "h", {wire::TargetAt("a", -1, 0), wire::TargetAt("b", 6, 1)}).ok();
  return client.DeleteSession(session).ok() && good;
}

bool Edit(FaultClient& client, testing::Random& random, std::uint64_t turn) {
  v1::EditHandlesRequest request;
  request.set_session_id("edits");
  request.set_handle_set_id("h");
  if (turn > 0) request.add_remove("p" + std::to_string(turn - 1));
  const auto vertex = static_cast<std::uint32_t>(random.Below(kGrid * kGrid));
  *request.add_add() = wire::VertexHandle("p" + std::to_string(turn), vertex);
  v1::EditHandlesResponse response;
  return client.Call(&Stub::EditHandles, request, &response).ok();
}

// All of it has to be refused.
bool Misbehave(FaultClient& client, testing::Random& random, const std::string& address) {
  switch (random.Below(4)) {
    case 0: {
      v1::PlanarMesh mesh = wire::Grid(10, 10);
      mesh.set_vertices(7, std::numeric_limits<double>::quiet_NaN());
      return client.Register("edits", "bad", mesh).error_code() == grpc::INVALID_ARGUMENT;
    }
    case 1:
      return client.Deform("nobody", "h", {}).error_code() == grpc::NOT_FOUND;
    case 2: {
      std::string noise = http2::Preface();
      for (int i = 0; i < 500; ++i) noise.push_back(static_cast<char>(random.Below(256)));
      RawPeer peer(address);
      peer.Send(noise);
      peer.HalfClose();
      return peer.IsClosed();
    }
    default: {
      v1::PlanarMesh mesh = wire::Grid(30, 30);
      mesh.set_triangles(5, 1u << 30u);
      return client.Register("edits", "bad", mesh).error_code() == grpc::INVALID_ARGUMENT;
    }
  }
}

bool MakeSession(FaultClient& client, const std::string& session) {
  return client.CreateSession(session).ok() &&
         client.Register(session, "m", wire::Grid(kGrid, kGrid)).ok() &&
         client
             .Compile(session, "m", "h",
                      {wire::VertexHandle("a", 0), wire::VertexHandle("b", kGrid)})
             .ok();
}

}  // namespace

SoakLoad::SoakLoad(const std::string& address) : address_(address) {
  good_ = Prepare();
  if (!good_) return;
  for (int i = 0; i < 2; ++i) {
    Add("drags", milliseconds(100), [this](FaultClient& client, testing::Random& random) {
      return Drag(client, random, false);
    });
  }
  Add("hang-ups", milliseconds(500),
      [this](FaultClient& client, testing::Random& random) { return Drag(client, random, true); });
  Add("edits", milliseconds(100),
      [turn = std::uint64_t{0}](FaultClient& client, testing::Random& random) mutable {
        return Edit(client, random, turn++);
      });
  Add("flattenings", milliseconds(300), Flatten);
  Add("sessions", milliseconds(300), Live);
  Add("bad input", milliseconds(200), [this](FaultClient& client, testing::Random& random) {
    return Misbehave(client, random, address_);
  });
}

SoakLoad::~SoakLoad() { Stop(); }

bool SoakLoad::Prepare() {
  FaultClient client(address_);
  return MakeSession(client, "drags") && MakeSession(client, "edits");
}

void SoakLoad::Add(const char* what, milliseconds period, Turn turn) {
  LoadCount& count = *counts_.emplace_back(std::make_unique<LoadCount>());
  count.what = what;
  const std::uint64_t seed = counts_.size();
  threads_.emplace_back([this, &count, period, seed, turn = std::move(turn)] {
    testing::Random random(seed);
    // Connections come and go too.
    while (true) {
      FaultClient client(address_);
      for (int i = 0; i < 50; ++i) {
        if (!turn(client, random)) ++count.wrong;
        ++count.done;
        if (StopWithin(period)) return;
      }
    }
  });
}

bool SoakLoad::Drag(FaultClient& client, testing::Random& random, bool hang_up) {
  constexpr int kFrames = 60;
  constexpr milliseconds kFrame{16};
  wire::DeformStream stream(client.deformation());
  stream.Opened("drags", "h", random.Coin() ? v1::DELIVERY_EVERY : v1::DELIVERY_LATEST);
  const auto frames = hang_up ? 1 + static_cast<int>(random.Below(kFrames)) : kFrames;
  for (int frame = 1; frame <= frames; ++frame) {
    stream.Update(static_cast<std::uint64_t>(frame),
                  {wire::TargetAt("a", random.Uniform(-9, 9), random.Uniform(-9, 9))});
    const auto answer = stream.Read();
    if (!answer || !answer->has_shape()) return false;
    if (StopWithin(kFrame)) break;
  }
  if (hang_up) {
    stream.Cancel();
    return stream.Finish().error_code() == grpc::CANCELLED;
  }
  stream.HalfClose();
  while (stream.Read()) {
  }
  return stream.Finish().ok();
}

bool SoakLoad::StopWithin(milliseconds period) {
  std::unique_lock lock(mutex_);
  return stopping_.wait_for(lock, period, [this] { return stop_; });
}

void SoakLoad::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stopping_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace arap::fault
