// What watch makes of two readings of the admin page.
#include "client/cli/watch/server_view.h"

#include <chrono>
#include <cmath>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

// Frames of which `fast` took at most 1 ms and `slow` 1 to 2 ms.
std::string Page(int fast, int slow, double busy) {
  std::ostringstream text;
  text << "# HELP arapd_sessions Sessions in memory.\n# TYPE arapd_sessions gauge\n"
       << "arapd_sessions 3\narapd_open_streams 2\narapd_connections 4\n"
       << "arapd_build_info{version=\"1.2.3\"} 1\nprocess_start_time_seconds 1000\n"
       << "process_resident_memory_bytes 36237312\nprocess_cpu_seconds_total " << busy << "\n"
       << "arapd_phase_seconds_bucket{phase=\"frame\",le=\"0.001\"} " << fast << "\n"
       << "arapd_phase_seconds_bucket{phase=\"frame\",le=\"0.002\"} " << fast + slow << "\n"
       << "arapd_phase_seconds_bucket{phase=\"frame\",le=\"+Inf\"} " << fast + slow << "\n"
       << "arapd_phase_seconds_bucket{phase=\"register\",le=\"+Inf\"} 99\n"
       << "arapd_rpcs_total{code=\"OK\",method=\"Deform\"} " << fast << "\n"
       << "arapd_rpcs_total{code=\"NOT_FOUND\",method=\"Deform\"} " << slow << "\n"
       << "arapd_workers{lane=\"interactive\"} 2\narapd_queue_length{lane=\"interactive\"} 5\n"
       << "arapd_busy_seconds_total{lane=\"interactive\"} " << busy << "\n";
  return text.str();
}

ServerView View(const std::string& before, const std::string& now, double seconds) {
  const auto first = ParseMetrics(before), second = ParseMetrics(now);
  EXPECT_TRUE(first && second);
  return ViewOf(*first, *second, seconds,
                std::chrono::system_clock::time_point(std::chrono::seconds(4600)));
}

TEST(ServerViewOf, TwoReadingsHasRatesAndQuantiles) {
  const ServerView view = View(Page(100, 0, 1), Page(190, 10, 3), 2);
  EXPECT_EQ(view.version, "1.2.3");
  EXPECT_EQ(view.uptime_seconds, 3600);
  EXPECT_EQ(view.sessions, 3);
  EXPECT_EQ(view.streams, 2);
  EXPECT_DOUBLE_EQ(view.frames.per_second, 50);
  EXPECT_NEAR(view.frames.p50, 0.001 * 50 / 90, 1e-12);
  EXPECT_NEAR(view.frames.p99, 0.001 + 0.001 * 9 / 10, 1e-12);
  EXPECT_TRUE(std::isnan(view.calls.p50)) << "there was none";
  EXPECT_DOUBLE_EQ(view.failed_per_second, 5);
  EXPECT_DOUBLE_EQ(view.processors, 1);
  ASSERT_EQ(view.lanes.size(), 3u);
  EXPECT_DOUBLE_EQ(view.lanes[0].busy, 0.5);
  EXPECT_EQ(view.lanes[0].waiting, 5);
}

TEST(ServerViewOf, AServerThatWasStartedAnewCountsFromZero) {
  const ServerView view = View(Page(1000, 500, 90), Page(10, 0, 1), 1);
  EXPECT_DOUBLE_EQ(view.frames.per_second, 10);
  EXPECT_DOUBLE_EQ(view.processors, 1);
}

TEST(ServerViewOf, IsShownInEightyColumns) {
  const ServerView view = View(Page(100, 0, 1), Page(190, 10, 3), 2);
  const std::string screen = ScreenOf(view);
  EXPECT_THAT(screen, HasSubstr("arapd 1.2.3, up 1 h 0 min\n"));
  EXPECT_THAT(screen, HasSubstr("frames              50.0     0.556       1.9\n"));
  EXPECT_THAT(screen, HasSubstr("interactive            2         0         5       50%"));
  std::istringstream lines(screen);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(CharactersIn(line), kLineWidth);
  EXPECT_THAT(LineOf(view), HasSubstr(" frames/s=50.0 "));
  const auto json = ToJson(view);
  EXPECT_EQ(json["frames"]["per_second"], 50);
  EXPECT_TRUE(json["calls"]["p50_seconds"].is_null()) << "never NaN";
  EXPECT_EQ(json["lanes"][0]["name"], "interactive");
}

TEST(ServerViewOf, APageOfSomethingElseIsRefused) {
  EXPECT_FALSE(ParseMetrics("<html>\n"));
  EXPECT_FALSE(ParseMetrics("a b\n"));
  EXPECT_FALSE(ParseMetrics(" 1\n"));
  EXPECT_TRUE(ParseMetrics(""));
  EXPECT_TRUE(ParseMetrics("a{b=\"c d\"} NaN\n"));
}

}  // namespace
}  // namespace arap::cli
