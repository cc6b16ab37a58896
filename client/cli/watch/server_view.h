// What a server does, from two readings of its admin page (/metrics, docs/operations.md).
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "arap/base/result.h"

namespace arap::cli {

// A reading: the value of every line, by its name with its labels as the page has them, such as
// arapd_queue_length{lane="jobs"}. Bounded by the text. kInternal where a line is not of that form.
using Metrics = std::map<std::string, double, std::less<>>;
Result<Metrics> ParseMetrics(std::string_view text);

// How long things took. Seconds; NaN when there was none.
struct Waits {
  double per_second = 0;
  double p50 = 0, p99 = 0;
};

struct LaneView {
  std::string name;
  double workers = 0, running = 0, waiting = 0;
  double busy = 0;            // of all its workers' time, 0 to 1
  double oldest_seconds = 0;  // how long the longest running job runs
};

struct ServerView {
  std::string version;
  double uptime_seconds = 0;
  double sessions = 0, streams = 0, connections = 0;
  double resident_bytes = 0, accounted_bytes = 0;
  double processors = 0;  // processor time a second
  Waits frames, frame_waits, calls;
  double replaced_per_second = 0, refused_per_second = 0, failed_per_second = 0;
  std::vector<LaneView> lanes;
};

// What lies between two readings that are `seconds` apart, above 0. After a new start of the server,
// whose counters begin at 0 again, what it has done since.
ServerView ViewOf(const Metrics& before, const Metrics& now, double seconds,
                  std::chrono::system_clock::time_point time);

// A screen of at most 80 columns.
std::string ScreenOf(const ServerView& view);
// One line, "name=value" with blanks between.
std::string LineOf(const ServerView& view);
nlohmann::ordered_json ToJson(const ServerView& view);

}  // namespace arap::cli
