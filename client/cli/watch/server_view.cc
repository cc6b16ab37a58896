#include "client/cli/watch/server_view.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/report.h"

namespace arap::cli {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double At(const Metrics& metrics, std::string_view name) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? 0 : found->second;
}

// How much a counter has grown.
double Growth(const Metrics& before, const Metrics& now, std::string_view name) {
  const double value = At(now, name), old = At(before, name);
  return value < old ? value : value - old;
}

// The same for all counters of a name, with any labels; `unless` is a label that leaves one out.
double GrowthOfAll(const Metrics& before, const Metrics& now, const std::string& name,
                   std::string_view unless = {}) {
  double sum = 0;
  for (auto line = now.lower_bound(name + "{"); line != now.end(); ++line) {
    if (!line->first.starts_with(name + "{")) break;
    if (!unless.empty() && line->first.find(unless) != std::string::npos) continue;
    sum += Growth(before, now, line->first);
  }
  return sum;
}

// The value of a label of a line, or empty.
std::string_view LabelOf(std::string_view line, std::string_view label) {
  const std::string begin = std::string(label) + "=\"";
  const std::size_t at = line.find(begin);
  if (at == std::string_view::npos) return {};
  line.remove_prefix(at + begin.size());
  return line.substr(0, line.find('"'));
}

// Of the histograms of a name whose lines have `with` in them, together.
Waits WaitsOf(const Metrics& before, const Metrics& now, const std::string& name,
              std::string_view with, double seconds) {
  std::map<double, double> buckets;  // up to a bound, how many
  const std::string begin = name + "_bucket{";
  for (auto line = now.lower_bound(begin); line != now.end(); ++line) {
    if (!line->first.starts_with(begin)) break;
    if (line->first.find(with) == std::string::npos) continue;
    const std::string_view bound = LabelOf(line->first, "le");
    double limit = std::numeric_limits<double>::infinity();
    if (bound != "+Inf") std::from_chars(bound.data(), bound.data() + bound.size(), limit);
    buckets[limit] += Growth(before, now, line->first);
  }
  const double count = buckets.empty() ? 0 : buckets.rbegin()->second;
  const auto quantile = [&](double part) {
    double low = 0, below = 0;
    for (const auto& [limit, upto] : buckets) {
      if (upto >= part * count && upto > below) {
        if (std::isinf(limit)) return low;  // beyond the last bound
        return low + (limit - low) * (part * count - below) / (upto - below);
      }
      low = limit;
      below = upto;
    }
    return kNone;
  };
  return {count / seconds, count > 0 ? quantile(0.5) : kNone, count > 0 ? quantile(0.99) : kNone};
}

std::string Milliseconds(double seconds) {
  return std::isnan(seconds) ? "-" : fmt::format("{:.3g}", seconds * 1000);
}

std::string Bytes(double bytes) {
  constexpr std::array<const char*, 5> kUnits{"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; bytes >= 1000 && unit + 1 < kUnits.size(); ++unit) bytes /= 1000;
  return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

std::string Duration(double seconds) {
  const auto whole = static_cast<long long>(std::clamp(seconds, 0.0, 1e12));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  if (whole < 86'400) return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
  return fmt::format("{} d {} h", whole / 86'400, whole / 3600 % 24);
}

nlohmann::ordered_json Number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json WaitsJson(const Waits& waits) {
  return {{"per_second", Number(waits.per_second)},
          {"p50_seconds", Number(waits.p50)},
          {"p99_seconds", Number(waits.p99)}};
}

}  // namespace

Result<Metrics> ParseMetrics(std::string_view text) {
  Metrics metrics;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.starts_with('#')) continue;
    const std::size_t space = line.rfind(' ');
    const std::string_view number = space == std::string_view::npos ? line : line.substr(space + 1);
    double value = 0;
    const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (space == std::string_view::npos || space == 0 || error != std::errc() ||
        stop != number.data() + number.size()) {
      return Fail(FaultKind::kInternal,
                  fmt::format("That is no page of metrics: '{}'.", line.substr(0, 100)));
    }
    metrics.insert_or_assign(std::string(line.substr(0, space)), value);
  }
  return metrics;
}

ServerView ViewOf(const Metrics& before, const Metrics& now, double seconds,
                  std::chrono::system_clock::time_point time) {
  ServerView view;
  const std::string build = "arapd_build_info{";
  if (const auto line = now.lower_bound(build);
      line != now.end() && line->first.starts_with(build)) {
    view.version = LabelOf(line->first, "version");
  }
  view.uptime_seconds =
      std::max(0.0, std::chrono::duration<double>(time.time_since_epoch()).count() -
                        At(now, "process_start_time_seconds"));
  view.sessions = At(now, "arapd_sessions");
  view.streams = At(now, "arapd_open_streams");
  view.connections = At(now, "arapd_connections");
  view.resident_bytes = At(now, "process_resident_memory_bytes");
  view.accounted_bytes = At(now, "arapd_accounted_bytes");
  view.processors = Growth(before, now, "process_cpu_seconds_total") / seconds;
  view.frames = WaitsOf(before, now, "arapd_phase_seconds", "phase=\"frame\"", seconds);
  view.frame_waits = WaitsOf(before, now, "arapd_queue_seconds", "lane=\"interactive\"", seconds);
  view.calls = WaitsOf(before, now, "arapd_rpc_seconds", "method=", seconds);
  view.replaced_per_second = Growth(before, now, "arapd_coalesced_frames_total") / seconds;
  view.refused_per_second = GrowthOfAll(before, now, "arapd_rejected_total") / seconds;
  view.failed_per_second = GrowthOfAll(before, now, "arapd_rpcs_total", "code=\"OK\"") / seconds;
  for (const char* name : {"interactive", "jobs", "control"}) {
    const std::string label = fmt::format("{{lane=\"{}\"}}", name);
    LaneView lane{name,
                  At(now, "arapd_workers" + label),
                  At(now, "arapd_jobs_running" + label),
                  At(now, "arapd_queue_length" + label),
                  0,
                  At(now, "arapd_oldest_job_seconds" + label)};
    if (lane.workers > 0) {
      lane.busy = Growth(before, now, "arapd_busy_seconds_total" + label) / seconds / lane.workers;
    }
    view.lanes.push_back(std::move(lane));
  }
  return view;
}

std::string ScreenOf(const ServerView& view) {
  std::string text =
      fmt::format("arapd {}, up {}\n\n", Printable(view.version), Duration(view.uptime_seconds));
  text += fmt::format("sessions {:<8} streams {:<8} connections {}\n", view.sessions, view.streams,
                      view.connections);
  text += fmt::format("memory {} ({} accounted), processors {:.2f}\n\n", Bytes(view.resident_bytes),
                      Bytes(view.accounted_bytes), view.processors);
  text += fmt::format("{:<14}{:>10}{:>10}{:>10}\n", "", "a second", "p50 ms", "p99 ms");
  for (const auto& [name, waits] :
       {std::pair("frames", view.frames), std::pair("frames waited", view.frame_waits),
        std::pair("calls", view.calls)}) {
    text += fmt::format("{:<14}{:>10.1f}{:>10}{:>10}\n", name, waits.per_second,
                        Milliseconds(waits.p50), Milliseconds(waits.p99));
  }
  text += fmt::format("{:<14}{:>10.1f}\n{:<14}{:>10.1f}\n{:<14}{:>10.1f}\n\n", "replaced",
                      view.replaced_per_second, "refused", view.refused_per_second, "calls failed",
                      view.failed_per_second);
  text += fmt::format("{:<14}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "lane", "workers", "running",
                      "waiting", "busy", "oldest s");
  for (const LaneView& lane : view.lanes) {
    text += fmt::format("{:<14}{:>10}{:>10}{:>10}{:>9.0f}%{:>10.1f}\n", lane.name, lane.workers,
                        lane.running, lane.waiting, 100 * lane.busy, lane.oldest_seconds);
  }
  return text;
}

std::string LineOf(const ServerView& view) {
  double waiting = 0;
  for (const LaneView& lane : view.lanes) waiting += lane.waiting;
  return fmt::format(
      "sessions={} streams={} frames/s={:.1f} frame_p99_ms={} waited_p99_ms={} calls/s={:.1f} "
      "waiting={} replaced/s={:.1f} refused/s={:.1f} failed/s={:.1f} processors={:.2f}\n",
      view.sessions, view.streams, view.frames.per_second, Milliseconds(view.frames.p99),
      Milliseconds(view.frame_waits.p99), view.calls.per_second, waiting, view.replaced_per_second,
      view.refused_per_second, view.failed_per_second, view.processors);
}

nlohmann::ordered_json ToJson(const ServerView& view) {
  nlohmann::ordered_json json{{"version", view.version},
                              {"uptime_seconds", view.uptime_seconds},
                              {"sessions", view.sessions},
                              {"streams", view.streams},
                              {"connections", view.connections},
                              {"resident_bytes", view.resident_bytes},
                              {"accounted_bytes", view.accounted_bytes},
                              {"processors", view.processors},
                              {"frames", WaitsJson(view.frames)},
                              {"frame_waits", WaitsJson(view.frame_waits)},
                              {"calls", WaitsJson(view.calls)},
                              {"replaced_per_second", view.replaced_per_second},
                              {"refused_per_second", view.refused_per_second},
                              {"failed_per_second", view.failed_per_second},
                              {"lanes", nlohmann::ordered_json::array()}};
  for (const LaneView& lane : view.lanes) {
    json["lanes"].push_back({{"name", lane.name},
                             {"workers", lane.workers},
                             {"running", lane.running},
                             {"waiting", lane.waiting},
                             {"busy", lane.busy},
                             {"oldest_seconds", lane.oldest_seconds}});
  }
  return json;
}

}  // namespace arap::cli
