#include "client/cli/commands/drag_report.h"

#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/report.h"

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const EditTimes& edit) {
  return {{"frame", edit.frame},
          {"removed", edit.removed},
          {"added", edit.added},
          {"round_trip_micros", edit.round_trip_micros},
          {"queue_micros", edit.queue_micros},
          {"solve_micros", edit.solve_micros}};
}

Json ToJson(double x, double y, const client::PickResult& pick) {
  Json json{{"point", {x, y}}, {"hit", pick.hit}};
  if (!pick.hit) return json;
  json["rest"] = {pick.rest_x, pick.rest_y};
  json["triangle"] = pick.triangle;
  json["bary"] = pick.barycentric;
  return json;
}

}  // namespace

std::string PickLines(std::span<const double> points, std::span<const client::PickResult> picks) {
  std::string lines;
  for (std::size_t i = 0; i < picks.size(); ++i) {
    auto out = std::back_inserter(lines);
    fmt::format_to(out, "pick {:.6g},{:.6g}: ", points[2 * i], points[2 * i + 1]);
    if (picks[i].hit) {
      fmt::format_to(out, "rest {:.6g},{:.6g} in triangle {}\n", picks[i].rest_x, picks[i].rest_y,
                     picks[i].triangle);
    } else {
      lines += "nothing there\n";
    }
  }
  return lines;
}

std::string JsonReport(const DragTimes& times, std::span<const double> points) {
  Json json{{"sent", times.sent},
            {"answered", times.answered},
            {"replaced", times.replaced},
            {"round_trip_micros", ToJson(PercentilesOf(times.round_trip_micros))},
            {"queue_micros", ToJson(PercentilesOf(times.queue_micros))},
            {"solve_micros", ToJson(PercentilesOf(times.solve_micros))},
            {"frames_with_flips", times.frames_with_flips},
            {"most_flips", times.most_flips},
            {"worst_handle_error", times.worst_handle_error},
            {"edits", Json::array()},
            {"picks", Json::array()}};
  for (const EditTimes& edit : times.edits) json["edits"].push_back(ToJson(edit));
  for (std::size_t i = 0; i < times.picks.size(); ++i) {
    json["picks"].push_back(ToJson(points[2 * i], points[2 * i + 1], times.picks[i]));
  }
  return json.dump(2) + "\n";
}

}  // namespace arap::cli
