// arapctl drag: a track through a live stream, as an interactive client would.
#include <algorithm>
#include <cmath>
#include <istream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/drag_loop.h"
#include "client/cli/commands/stage.h"
#include "client/cli/patience.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/drawing/svg.h"
#include "core/files/mesh_file.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

// X,Y on the command line. Not an aggregate: CLI11 would make one of a single number.
struct PickPoint {
  PickPoint() = default;

  double x = 0, y = 0;
};

std::istream& operator>>(std::istream& in, PickPoint& point) {
  char comma = 0;
  in >> point.x >> comma >> point.y;
  if (comma != ',') in.setstate(std::ios::failbit);
  return in;
}

struct DragOptions {
  StageOptions stage;
  client::Delivery delivery = client::Delivery::kLatest;
  double rate = 60;
  std::optional<double> resume;  // seconds
  double silence = 30;           // seconds
  std::string json;
  std::vector<PickPoint> picks;
};

using Json = nlohmann::ordered_json;

Json ToJson(const EditTimes& edit) {
  return {{"frame", edit.frame},
          {"removed", edit.removed},
          {"added", edit.added},
          {"round_trip_micros", edit.round_trip_micros},
          {"queue_micros", edit.queue_micros},
          {"solve_micros", edit.solve_micros}};
}

Json ToJson(Complex point, const std::optional<Pick>& pick) {
  Json json{{"point", {point.real(), point.imag()}}, {"hit", pick.has_value()}};
  if (!pick) return json;
  json["rest"] = {pick->rest.real(), pick->rest.imag()};
  json["triangle"] = pick->triangle;
  json["bary"] = pick->barycentric;
  return json;
}

// As many digits after the point as say a millionth of the size of the mesh, wherever it lies.
int DigitsOf(const PlanarMesh& mesh) {
  Bounds bounds;
  bounds.Add(mesh.vertices);
  const double size = std::max(bounds.width(), bounds.height());
  return size > 0 ? static_cast<int>(std::clamp(6 - std::floor(std::log10(size)), 1.0, 18.0)) : 1;
}

// Where each picked point was at rest, a line for each: "pick 3,4: rest 1,2 in triangle 7"
// or "pick 9,9: nothing there". `picks` are as many as points.
std::string PickLines(std::span<const Complex> points, std::span<const std::optional<Pick>> picks,
                      const PlanarMesh& mesh) {
  const int digits = DigitsOf(mesh);
  std::string lines;
  for (std::size_t i = 0; i < picks.size(); ++i) {
    auto out = std::back_inserter(lines);
    fmt::format_to(out, "pick {},{}: ", points[i].real(), points[i].imag());
    if (picks[i]) {
      fmt::format_to(out, "rest {},{} in triangle {}\n", SvgNumber(picks[i]->rest.real(), digits),
                     SvgNumber(picks[i]->rest.imag(), digits), picks[i]->triangle);
    } else {
      lines += "nothing there\n";
    }
  }
  return lines;
}

// All times, edits and picks.
std::string TimesReport(const DragTimes& times, std::span<const Complex> points) {
  const bool told = times.flips.are_told();
  Json json{{"sent", times.sent},
            {"answered", times.answered},
            {"replaced", times.replaced},
            {"lost", times.lost},
            {"resumed", times.resumed},
            {"round_trip_micros", ToJson(PercentilesOf(times.round_trip_micros))},
            {"queue_micros", ToJson(PercentilesOf(times.queue_micros))},
            {"solve_micros", ToJson(PercentilesOf(times.solve_micros))},
            {"frames_measured", times.flips.measured},
            {"frames_with_flips", told ? Json(times.flips.with_flips) : Json()},
            {"most_flips", told ? Json(times.flips.most) : Json()},
            {"worst_handle_error", times.worst_handle_error},
            {"edits", Json::array()},
            {"picks", Json::array()}};
  for (const EditTimes& edit : times.edits) json["edits"].push_back(ToJson(edit));
  for (std::size_t i = 0; i < times.picks.size(); ++i) {
    json["picks"].push_back(ToJson(points[i], times.picks[i]));
  }
  return JsonText(json);
}

std::chrono::milliseconds Millis(double seconds) {
  return std::chrono::milliseconds(std::llround(std::ceil(seconds * 1000)));
}

// A private server that is gone does not come back.
client::StreamOptions HowToStream(const DragOptions& options) {
  client::StreamOptions how{options.delivery, {options.stage.deform, !options.stage.out.empty()}};
  how.resume_within = Millis(options.resume.value_or(options.stage.server.spawn ? 0 : 30));
  how.silence = Millis(options.silence);
  how.heartbeat = std::clamp(how.silence / 3, std::chrono::milliseconds(1), how.heartbeat);
  how.answer = options.stage.timeout.value();
  return how;
}

Warning ToWarning(const DragGap& gap) {
  const auto times = [](std::size_t n) { return n == 1 ? "once" : fmt::format("{} times", n); };
  return {
      "stream_resumed",
      gap.lost,
      {},
      fmt::format("The stream was lost {}{} and went on after {}; {} without a shape.",
                  times(gap.losses), gap.after ? fmt::format(" after frame {}", *gap.after) : "",
                  Numbered(gap.attempts, "attempt"), Numbered(gap.lost, "frame"))};
}

Status Drag(const DragOptions& options) {
  TRY(const Stage stage, Stage::Open(options.stage));
  std::vector<Complex> points;
  for (const PickPoint& pick : options.picks) points.emplace_back(pick.x, pick.y);
  const DragScript script(stage, options.stage.hard, points);
  if (!points.empty() && script.frame_count() == 0) {
    return Fail(FaultKind::kInvalidOption, "--pick asks for the last frame; the track has none.");
  }
  std::optional<ShapesFile> shapes;
  if (!options.stage.out.empty()) {
    shapes.emplace(options.stage.out, stage.mesh().vertices.size());
  }
  TRY(client::DeformStream stream, stage.session().OpenStream(kHandleSet, HowToStream(options)));

  const bool every = options.delivery == client::Delivery::kEvery;
  FilmMaker film(options.stage, stage, every);
  const auto play = [&]() -> Result<DragTimes> {
    // The stream itself knows how long it waits; this is for Ctrl-C.
    Patience patience(std::chrono::hours(24 * 365), [&stream] { stream.Cancel(); });
    const DragEvents events{[&](std::size_t frame, client::Shape&& shape) -> Status {
                              if (shapes) CHECK_OK(shapes->Write(frame, shape.positions));
                              film.Add(frame, std::move(shape.positions));
                              return {};
                            },
                            [](const DragGap& gap) { PrintWarnings({ToWarning(gap)}); }};
    auto times = every ? DragEvery(stream, script, events)
                       : DragLatest(stream, script, options.rate, events);
    if (times) return times;
    Fault fault = patience.Explain(times.error());
    if (fault.kind == FaultKind::kDeadlineExceeded) {
      fault.message += " --timeout is how long to wait.";
    }
    return Fail(InOwnWords(std::move(fault), stage.Origins()));
  };
  TRY(const DragTimes times, play());

  const Percentiles round_trip = PercentilesOf(times.round_trip_micros);
  const std::string caption =
      fmt::format("{}: {}, {}, {} replaced; round trip p50 {:.0f} µs, p99 {:.0f} µs; {}",
                  every ? "every" : "latest", Numbered(times.sent, "update"),
                  Numbered(times.answered, "answer"), times.replaced, round_trip.p50,
                  round_trip.p99, Describe(times.flips));
  const std::string resumed =
      times.resumed == 0 ? ""
                         : fmt::format("; resumed {}, {} lost", Numbered(times.resumed, "time"),
                                       Numbered(times.lost, "frame"));
  Say(fmt::format(
      "{}{}\nsolve p50 {:.0f} µs, worst handle error {:.3g}, most flips in a frame {}\n", caption,
      resumed, PercentilesOf(times.solve_micros).p50, times.worst_handle_error,
      times.flips.are_told() ? std::to_string(times.flips.most) : "not measured"));
  for (const EditTimes& edit : times.edits) Say(Describe(edit) + "\n");
  Say(PickLines(points, times.picks, stage.mesh()));
  if (shapes) CHECK_OK(shapes->Close());
  if (!options.json.empty()) CHECK_OK(WriteTextFile(options.json, TimesReport(times, points)));
  return film.Write(caption);
}

}  // namespace

void AddDrag(CLI::App& app, Run& run) {
  auto options = std::make_shared<DragOptions>();
  CLI::App* const command =
      app.add_subcommand("drag", "Play a track through a live stream and take the times");
  AddStageOptions(*command, options->stage, /*out_required=*/false);
  AddChoice<client::Delivery>(
      *command, "--delivery", options->delivery,
      {{"latest", client::Delivery::kLatest}, {"every", client::Delivery::kEvery}},
      "answer the latest update, or every one with a single update on its way; default latest");
  command
      ->add_option("--rate", options->rate, "updates per second, for --delivery latest; default 60")
      ->check(CLI::Range(0.1, 1e6).description(""))
      ->option_text("PER_SECOND");
  command
      ->add_option_function<double>(
          "--resume", [options](double seconds) { options->resume = seconds; },
          "open a stream that was lost again for so many seconds and go on; 0: not at all; default "
          "30, with --spawn 0")
      ->check(Between(0, 1e6))
      ->option_text("SECONDS");
  command
      ->add_option("--silence", options->silence,
                   "count the stream as lost when not even a sign of life was heard for so many "
                   "seconds; default 30")
      ->check(Positive())
      ->option_text("SECONDS");
  command
      ->add_option("--pick", options->picks,
                   "say where this point of the last frame was at rest, and in which triangle; may "
                   "be given again")
      ->allow_extra_args(false)
      ->option_text("X,Y");
  AddOutput(*command, "--json", options->json,
            "write the times, edits and picks; - is standard output, errors too", "FILE.json");
  command->callback([options, &run] {
    run = [options] {
      const Status done = Drag(*options);
      if (!done && options->json == kStandardStream) return Finish(Fail(done.error()), true);
      return ExitCode(done);
    };
  });
}

}  // namespace arap::cli
