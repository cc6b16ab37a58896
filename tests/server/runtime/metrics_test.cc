// Metrics: what is counted is served in the text of Prometheus.
#include "server/runtime/metrics.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include "tests/support/bounded.h"

namespace arap::runtime {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// gRPC may end a call while the process already ends. The handler runs after the destructors of
// whatever became static since it was registered, and freed memory does not keep what was in it.
TEST(MetricsDeathTest, CountsWhileTheProcessEnds) {
  static Metrics* late = nullptr;
  const auto end = [] {
    std::atexit([] { late->Rpc("Late", "OK", 0.1); });
    late = new Metrics;
    late->Rpc("Early", "OK", 0.1);
    mallopt(M_PERTURB, 0xA5);
    std::exit(0);
  };
  EXPECT_EXIT(end(), ::testing::ExitedWithCode(0), "");
}

TEST(MetricsTest, CountsRpcsByMethodAndCode) {
  Metrics metrics;
  metrics.Rpc("Deform", "OK", 0.002);
  metrics.Rpc("Deform", "OK", 0.2);
  metrics.Rpc("Deform", "NOT_FOUND", 0.002);
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr("arapd_rpcs_total{code=\"OK\",method=\"Deform\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("arapd_rpcs_total{code=\"NOT_FOUND\",method=\"Deform\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("arapd_rpc_seconds_bucket{method=\"Deform\",le=\"0.0025\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("arapd_rpc_seconds_count{method=\"Deform\"} 3\n"));
}

TEST(MetricsTest, ServesEveryPhaseFromTheStart) {
  Metrics metrics;
  metrics.Phase(Phase::kFrame, 0.001);
  const std::string text = metrics.Text();
  for (std::size_t i = 0; i < kPhases; ++i) {
    const auto phase = static_cast<Phase>(i);
    EXPECT_THAT(text, HasSubstr(std::string("arapd_phase_seconds_count{phase=\"") +
                                PhaseName(phase) + "\"} " + (phase == Phase::kFrame ? "1" : "0")));
  }
}

TEST(MetricsTest, CountsEverythingElse) {
  Metrics metrics;
  metrics.Queue("jobs", 0.5);
  metrics.Store("put", 0.1, true);
  metrics.Store("put", 0.1, false);
  metrics.CacheHit("meshes");
  metrics.CacheMiss("meshes");
  metrics.Evicted("meshes", 1000);
  metrics.Evicted("meshes", 24);
  metrics.Coalesced(7);
  metrics.Rejected("max_sessions");
  const std::string text = metrics.Text();
  for (const char* line :
       {"arapd_queue_seconds_sum{lane=\"jobs\"} 0.5", "arapd_store_seconds_count{op=\"put\"} 2",
        "arapd_store_failures_total{op=\"put\"} 1", "arapd_cache_hits_total{cache=\"meshes\"} 1",
        "arapd_cache_misses_total{cache=\"meshes\"} 1", "arapd_evictions_total{cache=\"meshes\"} 2",
        "arapd_evicted_bytes_total{cache=\"meshes\"} 1024", "arapd_coalesced_frames_total 7",
        "arapd_rejected_total{quota=\"max_sessions\"} 1"}) {
    EXPECT_THAT(text, HasSubstr(std::string(line) + "\n"));
  }
}

TEST(MetricsTest, ServesNoughtWhereAsked) {
  Metrics metrics;
  EXPECT_THAT(metrics.Text(), Not(HasSubstr("cache=")));
  metrics.ServeCache("meshes");
  metrics.ServeQuota("queue");
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr("arapd_cache_hits_total{cache=\"meshes\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("arapd_evicted_bytes_total{cache=\"meshes\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("arapd_rejected_total{quota=\"queue\"} 0\n"));
}

TEST(MetricsTest, ReadsWhatIsWatchedWhenAsked) {
  Metrics metrics;
  double sessions = 1;
  metrics.Watch({"arapd_sessions", "Sessions."}, Metrics::Kind::kGauge, {},
                [&] { return sessions; });
  metrics.Watch({"arapd_jobs_total", "Jobs."}, Metrics::Kind::kCounter, {{"lane", "a"}},
                [] { return 3; });
  metrics.Watch({"arapd_jobs_total", "Jobs."}, Metrics::Kind::kCounter, {{"lane", "b"}},
                [] { return 4; });
  sessions = 5;
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr("# TYPE arapd_sessions gauge\narapd_sessions 5\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE arapd_jobs_total counter\narapd_jobs_total{lane=\"a\"} 3\n"
                              "arapd_jobs_total{lane=\"b\"} 4\n"));
}

TEST(MetricsTest, CountsFromManyThreads) {
  Metrics metrics;
  std::vector<testing::BoundedThread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back("the threads that count", [&] {
      for (int k = 0; k < 1'000; ++k) {
        metrics.Rpc(k % 2 == 0 ? "A" : "B", "OK", 0.1);
        metrics.CacheHit("c");
      }
    });
  }
  threads.clear();
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr("arapd_rpcs_total{code=\"OK\",method=\"A\"} 2000\n"));
  EXPECT_THAT(text, HasSubstr("arapd_cache_hits_total{cache=\"c\"} 4000\n"));
}

}  // namespace
}  // namespace arap::runtime
