// arapctl drag: a track through a live stream, as an interactive client would.
#include <istream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "client/cli/adapt.h"
#include "client/cli/commands/commands.h"
#include "client/cli/commands/drag_loop.h"
#include "client/cli/commands/drag_report.h"
#include "client/cli/commands/stage.h"
#include "client/cli/report.h"
#include "core/files/shapes.h"
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
  std::string json;
  std::vector<PickPoint> picks;
};

Status Drag(const DragOptions& options) {
  const Result<Stage> stage = Stage::Open(options.stage);
  if (!stage) return Fail(stage.error());
  std::vector<double> points;
  for (const PickPoint& pick : options.picks) points.insert(points.end(), {pick.x, pick.y});
  const DragScript script(stage->track(), options.stage.hard, points);
  if (!points.empty() && script.frame_count() == 0) {
    return Fail(FaultKind::kInvalidOption, "--pick asks for the last frame; the track has none");
  }
  std::optional<ShapesFile> shapes;
  if (!options.stage.out.empty()) {
    shapes.emplace(options.stage.out, stage->mesh().vertices.size());
  }
  FilmMaker film(options.stage, *stage);
  client::DeformOptions deform = options.stage.deform;
  deform.float64 = shapes.has_value();
  Result<client::DeformStream> stream =
      stage->session().OpenStream(kHandleSet, options.delivery, deform);
  if (!stream) return Fail(stream.error());

  const OnShape on_shape = [&](std::size_t frame, const client::Shape& shape) {
    if (shapes) shapes->Write(frame, ToPoints(shape.positions));
    film.Add(frame, shape);
  };
  const bool every = options.delivery == client::Delivery::kEvery;
  const Result<DragTimes> times = every ? DragEvery(*stream, script, on_shape)
                                        : DragLatest(*stream, script, options.rate, on_shape);
  if (!times) return Fail(times.error());

  const Percentiles round_trip = PercentilesOf(times->round_trip_micros);
  const std::string caption = fmt::format(
      "{}: {} updates, {} answers, {} replaced; round trip p50 {:.0f} µs, p99 {:.0f} µs; {} frames "
      "with flips",
      every ? "every" : "latest", times->sent, times->answered, times->replaced, round_trip.p50,
      round_trip.p99, times->frames_with_flips);
  fmt::print("{}\nsolve p50 {:.0f} µs, worst handle error {:.3g}, most flips in a frame {}\n",
             caption, PercentilesOf(times->solve_micros).p50, times->worst_handle_error,
             times->most_flips);
  for (const EditTimes& edit : times->edits) fmt::print("{}\n", Describe(edit));
  fmt::print("{}", PickLines(points, times->picks));
  if (shapes) {
    if (Status closed = shapes->Close(); !closed) return closed;
  }
  if (!options.json.empty()) {
    if (Status written = WriteTextFile(options.json, JsonReport(*times, points)); !written)
      return written;
  }
  return film.Write(caption);
}

}  // namespace

void AddDrag(CLI::App& app, Run& run) {
  auto options = std::make_shared<DragOptions>();
  CLI::App* const command =
      app.add_subcommand("drag", "Play a track through a live stream and take the times");
  AddStageOptions(*command, options->stage, /*out_required=*/false);
  command
      ->add_option("--delivery", options->delivery,
                   "answer the latest update, or every one with a single update on its way; "
                   "default latest")
      ->transform(CLI::CheckedTransformer(
                      std::map<std::string, client::Delivery>{{"latest", client::Delivery::kLatest},
                                                              {"every", client::Delivery::kEvery}})
                      .description(""))
      ->option_text("latest|every");
  command
      ->add_option("--rate", options->rate, "updates per second, for --delivery latest; default 60")
      ->check(CLI::Range(0.1, 1e6).description(""))
      ->option_text("PER_SECOND");
  command
      ->add_option("--pick", options->picks,
                   "say where this point of the last frame was at rest, and in which triangle; may "
                   "be given again")
      ->allow_extra_args(false)
      ->option_text("X,Y");
  command->add_option("--json", options->json, "write the times, edits and picks")
      ->option_text("FILE.json");
  command->callback([options, &run] {
    run = [options] {
      const Status dragged = Drag(*options);
      return dragged ? kOk : Complain(dragged.error());
    };
  });
}

}  // namespace arap::cli
