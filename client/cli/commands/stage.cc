#include "client/cli/commands/stage.h"

#include <climits>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"
#include "core/files/text_file.h"
#include "core/files/track_file.h"

namespace arap::cli {

void AddStageOptions(CLI::App& command, StageOptions& options, bool out_required) {
  command.add_option("MESH", options.mesh, "the mesh: an OBJ or OFF file in the plane")->required();
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
  command.add_flag("--hard", options.hard,
                   "meet the targets exactly, whatever weight the track gives");
}

void Stage::Release::operator()(const client::Session* session) const {
  // It would expire anyway, and nobody could act on a failure.
  (void)session->Delete({std::chrono::seconds(5)});
  delete session;
}

Stage::Stage(Connection connection, client::Session session, PlanarMesh mesh, Track track)
    : connection_(std::move(connection)),
      session_(new client::Session(std::move(session))),
      mesh_(std::move(mesh)),
      track_(std::move(track)) {}

Stage::~Stage() = default;

Result<Stage> Stage::Open(const StageOptions& options) {
  std::vector<Warning> notes;
  TRY(PlanarMesh mesh, ReadPlanarMesh(options.mesh, &notes));
  PrintWarnings(notes);
  TRY(Track track, ReadTrack(options.track));
  PrintWarnings(track.warnings);
  TRY(Connection connection, Connection::Open(options.server));
  const client::CallOptions call{options.timeout.value()};
  TRY(client::Session session, connection.client().CreateSession({}, call));
  Stage stage(std::move(connection), std::move(session), std::move(mesh), std::move(track));

  EnergyOptions energy = options.energy;
  if (options.as_published) {
    energy.basis = Basis::kEdgeAsPublished;
    energy.weights = Weights::kUniform;
  }
  energy.rigidity = stage.track_.rigidity;
  TRY(const auto registered, stage.session().RegisterMesh(stage.mesh_, energy, {}, call));
  PrintWarnings(registered.mesh.report.warnings);
  TRY(const auto compiled,
      stage.session().CompileHandles(kHandleSet, registered.mesh.id,
                                     ToHandles(stage.track_, options.hard), call));
  PrintWarnings(compiled.handle_set.warnings);
  stage.register_micros_ = registered.solve_micros;
  stage.compile_micros_ = compiled.solve_micros;
  return stage;
}

FilmMaker::FilmMaker(const StageOptions& options, const Stage& stage)
    : svg_(options.svg),
      frames_svg_(options.frames_svg),
      track_(stage.track()),
      segments_(SegmentsOf(track_)) {
  film_.triangles = stage.mesh().triangles;
}

void FilmMaker::Add(std::size_t frame, std::vector<Complex> positions) {
  if (svg_.empty() && frames_svg_.empty()) return;
  film_.shapes.push_back(std::move(positions));
  film_.handles.push_back(HandlesAt(frame));
  film_.numbers.push_back(frame);
}

std::vector<Complex> FilmMaker::HandlesAt(std::size_t frame) const {
  std::size_t count = track_.handles.size();
  for (const TrackEdit& edit : track_.edits) count += edit.add.size();
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Complex> handles(count, {kNone, kNone});
  const std::vector<std::size_t>& numbers = SegmentAt(segments_, frame).numbers;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    handles[numbers[k]] = track_.frames[frame].targets[k].position;
  }
  return handles;
}

Status FilmMaker::Write(const std::string& caption) {
  constexpr std::size_t kSheetFrames = 8;
  if (film_.frame_count() == 0) return {};
  film_.caption = caption;
  if (!svg_.empty()) CHECK_OK(WriteTextFile(svg_, FormatAnimation(film_)));
  if (!frames_svg_.empty()) return WriteTextFile(frames_svg_, FormatSheet(film_, kSheetFrames));
  return {};
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
