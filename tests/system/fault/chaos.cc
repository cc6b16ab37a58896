// Three servers over one Redis, behind the real haproxy, are killed, drained and frozen in turn while
// streams drag and calls are made: is an answer wrong, is a stream or a session lost?
//
// Usage: arap_chaos [MINUTES]   (3 unless told). See script/soak.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "arap/client/client.h"
#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "client/cli/sample/samples.h"
#include "tests/server/store/redis_server.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/haproxy.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr std::size_t kServers = 3, kStreams = 20, kCallers = 4, kPoses = 16;
// Kept by each caller; older ones are deleted.
constexpr std::size_t kKeptSessions = 40;
constexpr seconds kPatience{60};

std::vector<client::Handle> Handles() {
  return {{"l", client::VertexAnchor{0}}, {"r", client::VertexAnchor{8}}};
}

// The places of the handles, and the shape that every server has to answer, to the last bit.
struct Pose {
  std::vector<Complex> places;
  std::vector<Complex> shape;
};

std::vector<Pose> MakePoses(const PlanarMesh& mesh) {
  const auto registered = RegisteredMesh::Register(mesh, {}).value();
  Deformer deformer(CompiledHandles::Compile(registered, Handles()).value());
  std::vector<Pose> poses(kPoses);
  for (std::size_t i = 0; i < kPoses; ++i) {
    poses[i].places = {{0, 0}, std::polar(9.0, 0.1 * static_cast<double>(i))};
    const std::array<Target, 2> targets{Target{poses[i].places[0]}, Target{poses[i].places[1]}};
    EXPECT_TRUE(deformer.Update(targets));
    const auto shape = deformer.positions();
    poses[i].shape.assign(shape.begin(), shape.end());
  }
  return poses;
}

struct Counts {
  std::atomic<std::size_t> shapes = 0, resumed = 0, lost_streams = 0;
  std::atomic<std::size_t> calls = 0, failed_calls = 0;
  std::atomic<std::size_t> wrong = 0, sessions = 0, lost_sessions = 0;
};

// What runs beside the chaos, until it is stopped.
class Load {
 public:
  Load(std::string address, PlanarMesh mesh)
      : address_(std::move(address)), mesh_(std::move(mesh)), poses_(MakePoses(mesh_)) {
    for (std::size_t i = 0; i < kStreams; ++i) threads_.emplace_back([this, i] { Drag(i); });
    for (std::size_t i = 0; i < kCallers; ++i) threads_.emplace_back([this, i] { Ask(i); });
  }
  ~Load() { Stop(); }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    stopping_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }
  const Counts& counts() const { return counts_; }

 private:
  // True when it is time to stop.
  bool StopWithin(milliseconds period) {
    std::unique_lock lock(mutex_);
    return stopping_.wait_for(lock, period, [this] { return stop_; });
  }
  void Tell(const char* what, const Fault& fault) {
    const std::lock_guard lock(mutex_);
    if (++told_ <= 20) std::printf("  %s: %s\n", what, fault.message.c_str());
  }
  // Makes a call that may not fail. Whether it was answered.
  template <class Answer>
  bool Answered(const char* what, const Answer& answer) {
    ++counts_.calls;
    if (answer) return true;
    ++counts_.failed_calls;
    Tell(what, answer.error());
    return false;
  }
  void Compare(const std::vector<Complex>& shape, const Pose& pose) {
    if (shape != pose.shape) ++counts_.wrong;
  }

  std::optional<client::Session> SetUp(const client::Client& client, const std::string& id) {
    client::SessionOptions named;
    named.id = id;
    const auto session = client.CreateSession(named, call_);
    if (!Answered("CreateSession", session)) return std::nullopt;
    if (!Answered("RegisterMesh", session->RegisterMesh(mesh_, {}, "m", call_)) ||
        !Answered("CompileHandles", session->CompileHandles("h", "m", Handles(), call_))) {
      return std::nullopt;
    }
    return *session;
  }

  // A drag of thirty updates a second, each with its answer.
  void Drag(std::size_t number) {
    const client::Client client = client::Client::Connect(address_);
    std::optional<client::Session> session;
    while (!session) {
      if (StopWithin(milliseconds(50))) return;
      session = SetUp(client, "stream-" + std::to_string(number));
    }
    std::uint64_t sequence = 0;
    while (!StopWithin(milliseconds(1))) {
      client::StreamOptions options{client::Delivery::kEvery, {.float64 = true}};
      options.heartbeat = seconds(1);
      options.silence = seconds(10);
      options.resume_within = kPatience;
      auto stream = session->OpenStream("h", options);
      if (!stream) {
        Tell("OpenStream", stream.error());
        ++counts_.failed_calls;
        continue;
      }
      while (!StopWithin(milliseconds(33))) {
        if (DragOnce(*stream, ++sequence)) continue;
        ++counts_.lost_streams;
        break;
      }
    }
  }
  // False when the stream is over.
  bool DragOnce(client::DeformStream& stream, std::uint64_t sequence) {
    const Pose& pose = poses_[sequence % kPoses];
    client::HandleUpdate update;
    update.sequence = sequence;
    update.positions = pose.places;
    (void)stream.Send(update);  // reading tells
    for (;;) {
      const auto event = stream.Read();
      if (!event || !*event) {
        Tell("stream", event ? Fault(FaultKind::kInternal, "It ended.") : event.error());
        return false;
      }
      if (std::holds_alternative<client::Resumed>(**event)) ++counts_.resumed;
      const auto* const shape = std::get_if<client::Shape>(&**event);
      if (shape == nullptr) continue;
      ++counts_.shapes;
      if (shape->sequence != sequence) ++counts_.wrong;
      Compare(shape->positions, pose);
      return true;
    }
  }

  // Sessions that come, are asked and go. What was acknowledged is there at the end.
  void Ask(std::size_t number) {
    const client::Client client = client::Client::Connect(address_);
    std::deque<client::Session> kept;
    for (std::size_t turn = 0; !StopWithin(milliseconds(50)); ++turn) {
      auto session = SetUp(client, "asker-" + std::to_string(number) + "-" + std::to_string(turn));
      if (!session) continue;
      ++counts_.sessions;
      Deform(*session, turn);
      kept.push_back(*std::move(session));
      Deform(kept[turn % kept.size()], turn + 1);
      if (kept.size() <= kKeptSessions) continue;
      // A delete whose answer was lost finds nothing when it is made again.
      const Status gone = kept.front().Delete(call_);
      if (gone || gone.error().kind != FaultKind::kNotFound) Answered("DeleteSession", gone);
      kept.pop_front();
    }
    for (const client::Session& session : kept) {
      const auto found = session.GetHandleSet("h", call_);
      if (!found && found.error().kind == FaultKind::kNotFound) ++counts_.lost_sessions;
      Deform(session, 3);
    }
  }
  void Deform(const client::Session& session, std::size_t turn) {
    const Pose& pose = poses_[turn % kPoses];
    const std::vector<HandleTarget> targets{{"l", {pose.places[0]}}, {"r", {pose.places[1]}}};
    const auto shape = session.Deform("h", targets, {.float64 = true}, {}, call_);
    if (Answered("Deform", shape)) Compare(shape->positions, pose);
  }

  const std::string address_;
  const PlanarMesh mesh_;
  const std::vector<Pose> poses_;
  const client::CallOptions call_{.timeout = kPatience, .retry_within = seconds(30)};
  Counts counts_;
  std::mutex mutex_;
  std::condition_variable stopping_;
  bool stop_ = false;     // guarded by mutex_
  std::size_t told_ = 0;  // likewise
  std::vector<std::thread> threads_;
};

// A port that was free a moment ago: the proxy has to find the admin page again after a restart.
std::string FreePort() {
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  EXPECT_EQ(bind(probe, any, size), 0);
  EXPECT_EQ(getsockname(probe, any, &size), 0);
  close(probe);
  return std::to_string(ntohs(address.sin_port));
}

void Pause(milliseconds period) {
  const auto end = steady_clock::now() + period;
  Eventually([&] { return steady_clock::now() >= end; }, std::chrono::hours(1));
}

// One server at a time, so that there is always one to go on with.
const char* Disturb(ServerProcess& server, std::size_t kind) {
  if (kind == 0) {
    server.Kill();
    Pause(seconds(1));
    EXPECT_TRUE(server.Start());
    return "killed";
  }
  if (kind == 1) {
    server.Signal(SIGTERM);
    EXPECT_EQ(server.Wait(kPatience), 0) << "a server that drains ends well";
    server.Kill();
    EXPECT_TRUE(server.Start());
    return "drained";
  }
  server.Signal(SIGSTOP);
  Pause(seconds(4));
  server.Signal(SIGCONT);
  return "frozen";
}

int Run(seconds length) {
  testing::RedisServer redis;
  const TempFolder blobs;
  std::deque<ServerProcess> servers;
  std::vector<Backend> backends;
  for (std::size_t i = 0; i < kServers; ++i) {
    const std::string admin = "127.0.0.1:" + FreePort();
    servers.emplace_back(
        std::vector<std::string>{"--store", redis.Url(), "--blob-dir", blobs.path(),
                                 "--drain-seconds", "5", "--admin", admin, "--access-log", "off"},
        "unix:{}/socket");
    if (!servers.back().Start()) return 1;
    backends.push_back({servers.back().address(), admin});
  }
  Haproxy proxy;
  if (!proxy.Start(backends)) return 1;

  Load load(proxy.address(), cli::MakeGrid(9, 9));
  std::map<std::string, std::size_t> done;
  const auto end = steady_clock::now() + length;
  for (std::size_t round = 0; steady_clock::now() < end; ++round) {
    Pause(seconds(3));
    // Every kind meets every server.
    ++done[Disturb(servers[round % kServers], (round + round / kServers) % 3)];
  }
  Pause(seconds(3));
  load.Stop();

  const Counts& counts = load.counts();
  for (const auto& [kind, times] : done) std::printf("%-9s %4zu times\n", kind.c_str(), times);
  std::printf("streams   %4zu, resumed %zu times, %zu shapes, lost %zu\n", kStreams,
              counts.resumed.load(), counts.shapes.load(), counts.lost_streams.load());
  std::printf("calls   %6zu, failed %zu\n", counts.calls.load(), counts.failed_calls.load());
  std::printf("sessions%6zu, lost %zu\n", counts.sessions.load(), counts.lost_sessions.load());
  std::printf("wrong   %6zu\n", counts.wrong.load());
  const bool good = counts.wrong + counts.lost_streams + counts.lost_sessions == 0 &&
                    counts.failed_calls == 0 && counts.shapes > 0 && counts.sessions > 0;
  return good && !::testing::Test::HasFailure() ? 0 : 1;
}

}  // namespace
}  // namespace arap::fault

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const double minutes = argc > 1 ? std::strtod(argv[1], nullptr) : 3;
  if (argc > 2 || !(minutes > 0 && minutes <= 1e4)) {
    std::fprintf(stderr, "usage: arap_chaos [MINUTES]\n");
    return 2;
  }
  return arap::fault::Run(std::chrono::seconds(static_cast<int>(std::ceil(minutes * 60))));
}
