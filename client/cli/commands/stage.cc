#include "client/cli/commands/stage.h"

#include <utility>

#include "client/cli/adapt.h"
#include "client/cli/commands/option_names.h"
#include "client/cli/report.h"
#include "core/files/mesh_file.h"

namespace arap::cli {

void AddStageOptions(CLI::App& command, StageOptions& options, bool out_required) {
  command.add_option("MESH", options.mesh, "the mesh: an OBJ or OFF file in the plane")->required();
  command.add_option("TRACK", options.track, "the handles and their frames: TRACK.json")
      ->required();
  AddServerFlags(command, options.server);
  CLI::Option* const out =
      command.add_option("--out", options.out, "write the shapes, a row per frame")
          ->option_text(out_required ? "FILE.csv REQUIRED" : "FILE.csv");
  out->required(out_required);
  command.add_option("--svg", options.svg, "write an animation that loops")
      ->option_text("FILE.svg");
  command.add_option("--frames-svg", options.frames_svg, "write a sheet of eight frames")
      ->option_text("FILE.svg");
  AddEnergyOptions(command, options.energy);
  CLI::Option* const as_published = command.add_flag(
      "--as-published", options.as_published,
      "the method as it was published: basis edge-as-published with uniform weights");
  as_published->excludes("--basis")->excludes("--weights");
  AddDeformOptions(command, options.deform);
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
  Result<PlanarMesh> mesh = ReadPlanarMesh(options.mesh);
  if (!mesh) return Fail(mesh.error());
  Result<Track> track = ReadTrack(options.track);
  if (!track) return Fail(track.error());
  Result<Connection> connection = Connection::Open(options.server);
  if (!connection) return Fail(connection.error());
  Result<client::Session> session = connection->client().CreateSession();
  if (!session) return Fail(session.error());
  Stage stage(*std::move(connection), *std::move(session), *std::move(mesh), *std::move(track));

  client::EnergyOptions energy = options.energy;
  if (options.as_published) {
    energy.basis = client::Basis::kEdgeAsPublished;
    energy.weights = client::EdgeWeights::kUniform;
  }
  energy.rigidity = stage.track_.rigidity;
  const auto registered = stage.session().RegisterMesh(ToClient(stage.mesh_), energy);
  if (!registered) return Fail(registered.error());
  PrintWarnings(registered->mesh.warnings);
  const auto compiled = stage.session().CompileHandles(
      kHandleSet, registered->mesh.id, ToClient(ToHandles(stage.track_, options.hard)));
  if (!compiled) return Fail(compiled.error());
  PrintWarnings(compiled->handle_set.warnings);
  stage.register_micros_ = registered->solve_micros;
  stage.compile_micros_ = compiled->solve_micros;
  return stage;
}

}  // namespace arap::cli
