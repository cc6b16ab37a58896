// The server as a whole: information, listening, overload, draining.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "server/engine.h"
#include "server/host/listen.h"
#include "tests/support/bounded.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class LifecycleTest : public WireTest {};

TEST_F(LifecycleTest, InfoTellsTheLimitsInForce) {
  options().limits.max_handles = 17;
  options().limits.max_ttl = std::chrono::hours(2);
  options().lanes.workers = 3;
  grpc::ClientContext context;
  v1::GetServerInfoResponse response;
  ASSERT_TRUE(server().GetServerInfo(&context, {}, &response).ok());
  EXPECT_EQ(response.version(), app::Version());
  EXPECT_EQ(response.limits().max_handles(), 17u);
  EXPECT_EQ(response.limits().max_ttl().seconds(), 7200);
  EXPECT_EQ(response.workers(), 3u);
  EXPECT_NE(
      std::find(response.capabilities().begin(), response.capabilities().end(), "stream.latest"),
      response.capabilities().end());
  // Every limit has a number.
  const auto* reflection = response.limits().GetReflection();
  const auto* descriptor = response.limits().GetDescriptor();
  for (int i = 0; i < descriptor->field_count(); ++i) {
    EXPECT_TRUE(reflection->HasField(response.limits(), descriptor->field(i)))
        << descriptor->field(i)->name();
  }
}

TEST_F(LifecycleTest, HealthKnowsTheServices) {
  const std::string address = host().addresses().front();
  for (const char* service :
       {"", "arap.v1.DeformationService", "arap.v1.FlatteningService", "arap.v1.ServerService"}) {
    EXPECT_EQ(Health(address, service), "\x08\x01") << service;
  }
}

TEST_F(LifecycleTest, FullQueueIsRefusedAndTriedAgain) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 4;
  SetUpCorners();
  const std::vector<v1::HandleTarget> targets = {TargetAt("a", 0, 0), TargetAt("b", 4, 0),
                                                 TargetAt("c", 0, 4)};
  for (runtime::WorkerPool* lane : {&host().engine().interactive, &host().engine().jobs}) {
    const bool interactive = lane == &host().engine().interactive;
    const auto call = [&] {
      return interactive ? Deform("s", "h", targets) : Register("s", "m2", Grid(3, 3));
    };
    {
      PoolGate gate(*lane);
      while (lane->TryPost([] {}, {app::kNobody})) {
      }
      ExpectError(call(), grpc::RESOURCE_EXHAUSTED, "OVERLOADED");
    }
    ASSERT_TRUE(testing::Await("the lane is empty", [&] { return lane->waiting() == 0; }));
    EXPECT_TRUE(call().ok());
  }
}

TEST_F(LifecycleTest, BusyJobsDoNotDelayADrag) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 4;
  SetUpCorners();
  PoolGate gate(host().engine().jobs);
  EXPECT_TRUE(
      Deform("s", "h", {TargetAt("a", 0, 0), TargetAt("b", 4, 0), TargetAt("c", 0, 4)}).ok());
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  stream.Update(1, {});
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
}

TEST_F(LifecycleTest, DrainTellsOpenStreams) {
  SetUpCorners();
  DeformStream idle(deformation());
  idle.Opened("s", "h", v1::DELIVERY_LATEST);
  host().Stop(std::chrono::minutes(1));
  EXPECT_FALSE(idle.Read().has_value());
  ExpectError(idle.Finish(), grpc::UNAVAILABLE, "DRAINING");
}

TEST_F(LifecycleTest, DrainLetsTheFrameInWorkOut) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 4;
  SetUpCorners();
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  PoolGate gate(host().engine().interactive);
  stream.Update(1, {});
  stream.Update(2, {});
  stream.Ping(1);
  host().engine().streams.Drain();
  gate.Open();
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  EXPECT_FALSE(stream.Read().has_value());
  ExpectError(stream.Finish(), grpc::UNAVAILABLE, "DRAINING");
  DeformStream late(deformation());
  EXPECT_FALSE(late.Read().has_value());
  ExpectError(late.Finish(), grpc::UNAVAILABLE, "DRAINING");
}

TEST_F(LifecycleTest, DrainEndsTracks) {
  SetUpCorners();
  PoolGate gate(host().engine().jobs);
  v1::DeformTrackRequest request;
  request.set_session_id("s");
  request.set_handle_set_id("h");
  for (const char* id : {"a", "b", "c"}) request.add_handle_ids(id);
  for (int i = 0; i < 100; ++i) request.add_frames()->mutable_positions()->Resize(6, 1);
  grpc::ClientContext context;
  SetDeadline(context);
  const auto reader = deformation().DeformTrack(&context, request);
  ASSERT_TRUE(
      testing::Await("the call is open", [&] { return host().engine().streams.count() > 0; }));
  host().engine().streams.Drain();
  gate.Open();
  v1::DeformTrackResponse response;
  EXPECT_FALSE(reader->Read(&response));
  ExpectError(reader->Finish(), grpc::UNAVAILABLE, "DRAINING");
}

TEST_F(LifecycleTest, StopRunsWhatWasAcceptedAndMayBeRepeated) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 4;
  SetUpCorners();
  PoolGate gate(host().engine().jobs);
  grpc::Status status;
  testing::BoundedThread caller("the registration",
                                [&] { status = Register("s", "m2", Grid(3, 3)); });
  ASSERT_TRUE(testing::Await("the job waits", [&] { return host().engine().jobs.waiting() > 0; }));
  testing::BoundedThread stopper("the stop", [&] { host().Stop(std::chrono::minutes(1)); });
  gate.Open();
  stopper.Join();
  caller.Join();
  EXPECT_TRUE(status.ok()) << status.error_message();
  host().Stop(std::chrono::seconds(0));
}

TEST_F(LifecycleTest, TakenPortIsAnError) {
  const std::string address = host().addresses().front();
  EXPECT_NE(address, "127.0.0.1:0");
  host::HostOptions second;
  second.listen = {address};
  const auto refused = host::Host::Start(second);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(address), std::string::npos);
}

TEST_F(LifecycleTest, BadAddressesAreErrors) {
  for (const char* bad : {"", "localhost", ":1", "127.0.0.1:", "127.0.0.1:99999", "127.0.0.1:a"}) {
    EXPECT_FALSE(host::CheckAddress(bad, host::kForCalls)) << bad;
  }
  EXPECT_FALSE(host::CheckAddress("unix:" + std::string(200, 'x'), host::kForCalls));
}

class UnixSocketTest : public WireTest {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "arapd.XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
    path_ = folder + "/socket";
    options().listen = {"unix:" + path_};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string folder_;
  std::string path_;
};

TEST_F(UnixSocketTest, ServesAndCleansUp) {
  EXPECT_EQ(host().addresses().front(), "unix:" + path_);
  EXPECT_TRUE(CreateSession("s").ok());
  EXPECT_TRUE(std::filesystem::exists(path_));
  host().Stop(std::chrono::seconds(0));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(UnixSocketTest, LiveSocketIsNotTaken) {
  EXPECT_TRUE(CreateSession("s").ok());
  EXPECT_FALSE(host::Host::Start(options()));
  EXPECT_TRUE(CreateSession("t").ok());
}

TEST_F(UnixSocketTest, SocketLeftBehindIsReplaced) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::copy(path_.begin(), path_.end(), name.sun_path);
  const int left = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(left, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  close(left);
  ASSERT_TRUE(std::filesystem::exists(path_));
  EXPECT_TRUE(CreateSession("s").ok());
}

TEST_F(UnixSocketTest, FileIsNotReplaced) {
  std::ofstream(path_) << "precious";
  EXPECT_FALSE(host::Host::Start(options()));
  EXPECT_TRUE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace arap::wire
