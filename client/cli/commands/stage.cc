#include "client/cli/commands/stage.h"

#include <algorithm>
#include <climits>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"
#include "core/files/plane_fit.h"
#include "core/files/text_file.h"
#include "core/files/track_file.h"

namespace arap::cli {

void AddStageOptions(CLI::App& command, StageOptions& options, bool out_required) {
  command
      .add_option("MESH", options.mesh,
                  "the mesh: an OBJ, OFF, STL, PLY or glTF file, also packed (.gz), in any plane")
      ->required();
  command.add_option("TRACK", options.track, "the handles and their frames: TRACK.json")
      ->required();
  AddServerFlags(command, options.server);
  AddTimeout(command, options.timeout);
  AddOutput(command, "--out", options.out, "write the shapes, a row per frame",
            out_required ? "FILE.csv REQUIRED" : "FILE.csv")
      ->required(out_required);
  AddOutput(command, "--svg", options.svg, "write an animation that loops", "FILE.svg");
  AddOutput(command, "--frames-svg", options.frames_svg, "write a sheet of eight frames",
            "FILE.svg");
  AddRepairs(command, options.repairs);
  AddBasis(command, options.energy.basis, /*planar=*/true, "what moves rigidly; default edge");
  AddWeights(command, options.energy.weights, "of the edges; default uniform");
  CLI::Option* const as_published = command.add_flag(
      "--as-published", options.as_published,
      "the method as it was published: basis edge-as-published with uniform weights");
  as_published->excludes("--basis")->excludes("--weights");
  AddChoice<DeformMode>(command, "--mode", options.deform.mode,
                        {{"rigid", DeformMode::kRigid},
                         {"similarity", DeformMode::kSimilarity},
                         {"baseline", DeformMode::kBaseline}},
                        "what to minimise; default rigid");
  command.add_option("--refine", options.deform.refine, "further iterations of the second step")
      ->check(CLI::Range(0, INT_MAX).description(""))
      ->option_text("N");
  AddMeasureEvery(command, options.deform);
  command.add_flag("--hard", options.hard,
                   "meet the targets exactly, whatever weight the track gives");
}

namespace {

// Where a field comes from that is all of one thing.
Origin Placed(const char* field, std::string place, Counting counting) {
  return {field, "", std::move(counting),
          [place = std::move(place)](std::string_view) { return place; }};
}

// "[3].targets[2].x" as steps.
std::vector<JsonStep> StepsOf(std::string_view path) {
  std::vector<JsonStep> steps;
  while (!path.empty()) {
    if (path.starts_with('[')) {
      steps.emplace_back(EntryOf(path, 0));
      path.remove_prefix(std::min(path.find(']'), path.size() - 1) + 1);
    } else {
      if (path.starts_with('.')) path.remove_prefix(1);
      const std::string_view member = path.substr(0, path.find_first_of(".["));
      if (!member.empty()) steps.emplace_back(member);
      path.remove_prefix(member.size());
    }
  }
  return steps;
}

}  // namespace

void Stage::Release::operator()(const client::Session* session) const {
  // It would expire anyway, and nobody could act on a failure.
  (void)session->Delete({std::chrono::seconds(5)});
  delete session;
}

Stage::Stage(const StageOptions& options, Connection connection, client::Session session,
             SurfaceFile mesh_file, PlanarMesh mesh, Track track, std::string track_text)
    : connection_(std::move(connection)),
      session_(new client::Session(std::move(session))),
      mesh_name_(options.mesh),
      track_name_(options.track),
      mesh_(std::move(mesh)),
      track_(std::move(track)),
      mesh_file_(std::make_unique<const SurfaceFile>(std::move(mesh_file))),
      track_text_(std::make_unique<const std::string>(std::move(track_text))) {}

Stage::~Stage() = default;

Result<Stage> Stage::Open(const StageOptions& options) {
  TRY(SurfaceFile file, ReadSurfaceFile(options.mesh));
  PrintWarnings(file.warnings);
  TRY(PlaneFit fit,
      InOwnWords(FitPlane(std::move(file.mesh)), {Placed("mesh", options.mesh, CountingOf(file))}));
  PrintWarnings(fit.notes);
  TRY(std::string text, ReadTextFile(options.track));
  TRY(Track track, ParseTrack(text, options.track));
  PrintWarnings(track.warnings);
  TRY(Connection connection, Connection::Open(options.server));
  const client::CallOptions call{options.timeout.value()};
  TRY(client::Session session, connection.client().CreateSession({}, call));
  Stage stage(options, std::move(connection), std::move(session), std::move(file),
              std::move(fit.mesh), std::move(track), std::move(text));

  EnergyOptions energy = options.energy;
  if (options.as_published) {
    energy.basis = Basis::kEdgeAsPublished;
    energy.weights = Weights::kUniform;
  }
  energy.rigidity = stage.track_.rigidity;
  const std::vector<Origin> origins = stage.Origins();
  TRY(const auto registered,
      InOwnWords(stage.session().RegisterMesh(stage.mesh_, energy, {}, call, options.repairs),
                 origins));
  PrintWarnings(InOwnWords(registered.mesh.report.warnings, stage.counting()));
  TRY(const auto compiled,
      InOwnWords(stage.session().CompileHandles(kHandleSet, registered.mesh.id,
                                                ToHandles(stage.track_, options.hard), call),
                 origins));
  PrintWarnings(InOwnWords(compiled.handle_set.warnings, stage.counting()));
  stage.register_micros_ = registered.solve_micros;
  stage.compile_micros_ = compiled.solve_micros;
  return stage;
}

std::vector<Origin> Stage::Origins() const {
  const auto flag = [counting = counting()](const char* field, const char* name) {
    return Placed(field, name, counting);
  };
  return {Placed("mesh", mesh_name_, counting()),
          InTrack("energy.rigidity", "the rigidity", {"rigidity"}),
          InTrack("handles", "the handle", {"handles"}),
          flag("energy.basis", "--basis"),
          flag("energy.weights", "--weights"),
          flag("repair.tolerance", "--weld"),
          flag("repair.stitch", "--stitch"),
          flag("options.mode", "--mode"),
          flag("options.refine", "--refine"),
          flag("pick_points", "--pick")};
}

Origin Stage::InTrack(std::string field, std::string entry, std::vector<JsonStep> steps,
                      std::size_t shift) const {
  // TRACK.json counts from 0, as the server does.
  return {std::move(field),
          std::move(entry),
          {},
          [text = track_text_.get(), name = track_name_, steps = std::move(steps),
           shift](std::string_view rest) {
            std::vector<JsonStep> path = steps;
            for (const JsonStep& step : StepsOf(rest)) {
              path.push_back(step);
              if (path.size() != steps.size() + 1) continue;
              if (auto* const index = std::get_if<std::size_t>(&path.back())) *index += shift;
            }
            return JsonPlace(*text, name, path);
          }};
}

FilmMaker::FilmMaker(const StageOptions& options, const Stage& stage, bool every)
    : svg_(options.svg),
      frames_svg_(options.frames_svg),
      track_(stage.track()),
      segments_(track_),
      handle_count_(track_.handles.size()),
      reel_(stage.mesh().triangles,
            every ? std::optional<std::size_t>(track_.frames.size()) : std::nullopt) {
  for (const TrackEdit& edit : track_.edits) handle_count_ += edit.add.size();
}

void FilmMaker::Add(std::size_t frame, std::vector<Complex> positions) {
  if (svg_.empty() && frames_svg_.empty()) return;
  reel_.Add(frame, std::move(positions), HandlesAt(frame));
}

std::vector<Complex> FilmMaker::HandlesAt(std::size_t frame) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Complex> handles(handle_count_, {kNone, kNone});
  const std::vector<std::size_t>& numbers = segments_.At(frame).numbers;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    handles[numbers[k]] = track_.frames[frame].targets[k].position;
  }
  return handles;
}

Status FilmMaker::Write(const std::string& caption) {
  if (reel_.frame_count() == 0) return {};
  if (!svg_.empty()) CHECK_OK(WriteTextFile(svg_, reel_.Animation(caption)));
  if (!frames_svg_.empty()) return WriteTextFile(frames_svg_, reel_.Sheet(caption));
  return {};
}

void Flips::Add(const client::ShapeQuality& quality) {
  ++frames;
  if (!quality.measured) return;
  ++measured;
  if (quality.flipped > 0) ++with_flips;
  most = std::max(most, quality.flipped);
}

std::string Describe(const Flips& flips) {
  if (flips.frames > 0 && flips.measured == 0) return "flips not measured";
  const std::string text = Numbered(flips.with_flips, "frame") + " with flips";
  if (flips.measured == flips.frames) return text;
  return fmt::format("{} of {} measured", text, flips.measured);
}

std::string Describe(const EditTimes& times) {
  std::string text = fmt::format("edit before frame {}: {} removed, {} added in {:.0f} µs",
                                 times.frame, times.removed, times.added, times.solve_micros);
  if (times.round_trip_micros > 0) {
    text += fmt::format(", round trip {:.0f} µs", times.round_trip_micros);
  }
  return text;
}

}  // namespace arap::cli
