// The admin page on its real port: life, readiness, and metrics after one of each RPC.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "server/host/admin_http.h"
#include "server/runtime/metrics.h"
#include "tests/support/bounded.h"
#include "tests/system/wire/http_get.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

using ::testing::HasSubstr;

class AdminTest : public WireTest {
 protected:
  AdminTest() { options().admin = "127.0.0.1:0"; }

  Page Get(const std::string& path) { return HttpGet(host().admin_address(), path); }
  std::string Ready() {
    const Page page = Get("/readyz");
    return std::to_string(page.status) + " " + nlohmann::json::parse(page.body).value("status", "");
  }

  // One of each RPC, and some that are refused.
  void UseEverything();
};

void AdminTest::UseEverything() {
  SetUpCorners();
  const std::vector<v1::HandleTarget> targets = {TargetAt("a", 0, 0), TargetAt("b", 4, 0),
                                                 TargetAt("c", 0, 4)};
  ASSERT_TRUE(Deform("s", "h", targets).ok());
  EXPECT_FALSE(Deform("nobody", "h", targets).ok());
  v1::EditHandlesRequest edit;
  edit.set_session_id("s");
  edit.set_handle_set_id("h");
  *edit.add_add() = VertexHandle("d", 24);
  v1::EditHandlesResponse edited;
  ASSERT_TRUE(Call(&Deformation::EditHandles, edit, &edited).ok());
  {
    DeformStream stream(deformation());
    stream.Opened("s", "h", v1::DELIVERY_LATEST);
    stream.Update(1, {});
    stream.ReadShape();
    stream.HalfClose();
    EXPECT_FALSE(stream.Read().has_value());
    ASSERT_TRUE(stream.Finish().ok());
  }
  v1::DeformTrackRequest track;
  track.set_session_id("s");
  track.set_handle_set_id("h");
  for (const char* id : {"a", "b", "c", "d"}) track.add_handle_ids(id);
  track.add_frames()->mutable_positions()->Resize(8, 1);
  grpc::ClientContext context;
  SetDeadline(context);
  const auto reader = deformation().DeformTrack(&context, track);
  v1::DeformTrackResponse frame;
  while (reader->Read(&frame)) {
  }
  ASSERT_TRUE(reader->Finish().ok());
  v1::FlattenRequest flatten;
  for (const double x : {0., 0., 0., 1., 0., 0., 0., 1., 0.})
    flatten.mutable_mesh()->add_vertices(x);
  for (const unsigned i : {0u, 1u, 2u}) flatten.mutable_mesh()->add_triangles(i);
  flatten.set_surface_key("key");
  for (int i = 0; i < 2; ++i) {
    grpc::ClientContext flatten_context;
    SetDeadline(flatten_context);
    v1::FlattenResponse flat;
    const grpc::Status status = flattening().Flatten(&flatten_context, flatten, &flat);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  grpc::ClientContext info_context;
  v1::GetServerInfoResponse info;
  ASSERT_TRUE(server().GetServerInfo(&info_context, {}, &info).ok());
}

TEST_F(AdminTest, AliveAndReady) {
  EXPECT_EQ(Get("/healthz").status, 200);
  EXPECT_EQ(Ready(), "200 ready");
  EXPECT_EQ(Get("/nothing").status, 404);
}

TEST_F(AdminTest, EveryRpcIsCounted) {
  UseEverything();
  const std::string text = Get("/metrics").body;
  for (const char* method : {"CreateSession", "RegisterMesh", "CompileHandles", "EditHandles",
                             "Deform", "StreamDeform", "DeformTrack", "Flatten", "GetServerInfo"}) {
    EXPECT_THAT(text,
                HasSubstr(std::string("arapd_rpcs_total{code=\"OK\",method=\"") + method + "\"} "));
  }
  EXPECT_THAT(text, HasSubstr("arapd_rpcs_total{code=\"NOT_FOUND\",method=\"Deform\"} 1\n"));
  for (const char* phase : {"register", "compile", "edit", "track", "flatten"}) {
    EXPECT_THAT(text, ::testing::Not(HasSubstr(std::string("arapd_phase_seconds_count{phase=\"") +
                                               phase + "\"} 0\n")));
  }
  EXPECT_THAT(text, HasSubstr("arapd_phase_seconds_count{phase=\"frame\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("arapd_cache_hits_total{cache=\"surface\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("arapd_sessions 1\n"));
  EXPECT_THAT(text, HasSubstr("arapd_open_streams 0\n"));
  for (const char* lane : {"interactive", "control", "jobs"}) {
    EXPECT_THAT(text, HasSubstr(std::string("arapd_queue_length{lane=\"") + lane + "\"} 0\n"));
    EXPECT_THAT(text, HasSubstr(std::string("arapd_queue_seconds_count{lane=\"") + lane + "\"} "));
  }
  for (const char* name : {"arapd_build_info{version=", "process_resident_memory_bytes ",
                           "process_open_fds ", "process_cpu_seconds_total "}) {
    EXPECT_THAT(text, HasSubstr(std::string("\n") + name));
  }
}

TEST_F(AdminTest, RefusalsAreCountedByQuota) {
  options().limits.max_sessions = 1;
  ASSERT_TRUE(CreateSession("s").ok());
  EXPECT_FALSE(CreateSession("t").ok());
  EXPECT_THAT(Get("/metrics").body, HasSubstr("arapd_rejected_total{quota=\"max_sessions\"} 1\n"));
}

// The names of the metrics that a dashboard asks for.
std::set<std::string> NamesIn(const std::string& text) {
  constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyz_";
  std::set<std::string> names;
  for (const char* const family : {"arapd_", "process_"}) {
    for (std::size_t at = 0; (at = text.find(family, at)) != std::string::npos;) {
      const std::size_t end = std::min(text.find_first_not_of(kLetters, at), text.size());
      if (at == 0 ||
          (std::isalnum(static_cast<unsigned char>(text[at - 1])) == 0 && text[at - 1] != '_'))
        names.insert(text.substr(at, end - at));
      at = end;
    }
  }
  return names;
}

TEST_F(AdminTest, DashboardAsksForWhatIsServed) {
  std::ifstream file(ARAP_DASHBOARD);
  ASSERT_TRUE(file) << ARAP_DASHBOARD;
  const auto dashboard = nlohmann::json::parse(file);
  UseEverything();
  const std::set<std::string> served = NamesIn(Get("/metrics").body);
  int queries = 0;
  for (const auto& panel : dashboard.at("panels")) {
    if (!panel.contains("targets")) continue;
    for (const auto& target : panel.at("targets")) {
      const std::string expression = target.at("expr").get<std::string>();
      const std::set<std::string> asked = NamesIn(expression);
      EXPECT_FALSE(asked.empty()) << expression;
      for (const std::string& name : asked) EXPECT_EQ(served.count(name), 1u) << name;
      ++queries;
    }
  }
  EXPECT_GT(queries, 10);
}

TEST_F(AdminTest, AlertsAskForWhatIsServed) {
  std::ostringstream rules;
  rules << std::ifstream(ARAP_ALERTS).rdbuf();
  UseEverything();
  const std::set<std::string> served = NamesIn(Get("/metrics").body);
  const std::set<std::string> asked = NamesIn(rules.str());
  EXPECT_GT(asked.size(), 5u);
  for (const std::string& name : asked) EXPECT_EQ(served.count(name), 1u) << name;
}

TEST_F(AdminTest, StuckLaneIsNotReadyUntilItMoves) {
  options().stuck_after = std::chrono::milliseconds(20);
  options().lanes.workers = 1;
  const std::string address = host().addresses().front();
  {
    PoolGate gate(host().engine().interactive);
    EXPECT_TRUE(testing::Await("503 stuck", [&] { return Ready() == "503 stuck"; }));
    EXPECT_THAT(Get("/readyz").body, HasSubstr("interactive"));
    EXPECT_EQ(Get("/healthz").status, 200);
    host().RefreshHealth();
    EXPECT_EQ(Health(address), "\x08\x02");
  }
  EXPECT_TRUE(testing::Await("200 ready", [&] { return Ready() == "200 ready"; }));
  host().RefreshHealth();
  EXPECT_EQ(Health(address), "\x08\x01");
}

TEST_F(AdminTest, JobsGiveWayToFramesAndYetEnd) {
  options().lanes = {1, 1};
  SetUpCorners();
  EXPECT_THAT(Get("/metrics").body, HasSubstr("arapd_gave_way_total{lane=\"jobs\"} 0\n"));
  PoolGate gate(host().engine().interactive);
  EXPECT_TRUE(Register("s", "n", Grid(3, 3)).ok());
  EXPECT_GT(host().engine().jobs.stats().gave_way, 0u);
}

TEST_F(AdminTest, LongJobsAreNotStuck) {
  options().stuck_after = std::chrono::milliseconds(1);
  PoolGate gate(host().engine().jobs);
  const auto& jobs = host().engine().jobs;
  EXPECT_TRUE(
      testing::Await("the job is old", [&] { return jobs.stats().oldest_running.count() > 0.01; }));
  EXPECT_EQ(Ready(), "200 ready");
}

TEST_F(AdminTest, DrainingServerIsNotReadyButServes) {
  SetUpCorners();
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  host().AnnounceStop();
  EXPECT_EQ(Ready(), "404 draining");
  EXPECT_EQ(Health(host().addresses().front()), "\x08\x02");
  host().RefreshHealth();
  EXPECT_EQ(Health(host().addresses().front()), "\x08\x02");
  stream.Update(1, {});
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  EXPECT_TRUE(CreateSession("t").ok());
}

TEST_F(AdminTest, AddressesAreChecked) {
  for (const char* bad : {"", "localhost", ":1", "127.0.0.1:", "127.0.0.1:99999", "127.0.0.1:a"}) {
    EXPECT_FALSE(host::CheckAddress(bad, host::kForOperators)) << bad;
  }
  EXPECT_TRUE(host::CheckAddress("[::1]:9464", host::kForOperators));
  const auto taken = host::AdminHttp::Start(host().admin_address(), {});
  ASSERT_FALSE(taken);
  EXPECT_THAT(taken.error().message, HasSubstr(host().admin_address()));
}

TEST_F(WireTest, NoAdminPageUnlessAsked) { EXPECT_TRUE(host().admin_address().empty()); }

}  // namespace
}  // namespace arap::wire
