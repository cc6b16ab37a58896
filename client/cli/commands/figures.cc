// arapctl figures: Figures 2, 3 and 6 of [II09], drawn from what a server answers.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/lay_flat.h"
#include "client/cli/connect/connection.h"
#include "client/cli/reply.h"
#include "client/cli/sample/samples.h"
#include "core/base/try.h"
#include "core/drawing/comparison.h"
#include "core/drawing/film.h"
#include "core/files/text_file.h"
#include "core/files/track.h"

namespace arap::cli {
namespace {

struct FiguresOptions {
  ServerFlags server;
  std::string out = ".";
  bool json = false;
};

// The sample character at a session, pulled by its five handles into one pose.
class Puppet {
 public:
  explicit Puppet(client::Session session)
      : session_(std::move(session)),
        mesh_(MakeCharacter(1.5 * kCharacterEdge)),
        track_(MakeCharacterTrack(mesh_)) {
    film_.triangles = mesh_.triangles;
  }

  // A panel of the rest shape.
  void AddRest(std::string label) {
    std::vector<Complex> handles;
    for (const TrackHandle& h : track_.handles) handles.push_back(h.rest);
    AddPanel(mesh_.vertices, std::move(handles), std::move(label));
  }

  // A panel of the pose. `spread` pulls the handles away from their middle, then the first one is
  // swung up: spread 1 keeps the distances about as they are.
  Status AddPose(Basis basis, DeformMode mode, double spread, std::string label) {
    const std::string id = fmt::format("figure-{}", poses_++);
    const EnergyOptions energy{basis, Weights::kUniform, {}};
    const client::CallOptions call{Timeout().value()};
    TRY([[maybe_unused]] const auto mesh, session_.RegisterMesh(mesh_, energy, id, call));
    TRY([[maybe_unused]] const auto set,
        session_.CompileHandles(id, id, ToHandles(track_, /*hard=*/false), call));
    const std::vector<HandleTarget> targets = Pose(spread);
    TRY(const client::Shape shape,
        session_.Deform(id, targets, {{mode, 0}, /*float64=*/true}, {}, call));
    std::vector<Complex> handles;
    handles.reserve(targets.size());
    for (const HandleTarget& t : targets) handles.push_back(t.target.position);
    AddPanel(shape.positions, std::move(handles), std::move(label));
    return {};
  }

  Film Take(std::string caption) {
    film_.caption = std::move(caption);
    Film film;
    film.triangles = film_.triangles;
    std::swap(film, film_);
    return film;
  }

 private:
  void AddPanel(std::vector<Complex> shape, std::vector<Complex> handles, std::string label) {
    film_.numbers.push_back(film_.frame_count());
    film_.shapes.push_back(std::move(shape));
    film_.handles.push_back(std::move(handles));
    film_.labels.push_back(std::move(label));
  }

  // The frame of the wave in which the arm is highest, spread about the middle of the handles.
  std::vector<HandleTarget> Pose(double spread) const {
    const std::vector<Target>& wave = track_.frames[track_.frames.size() / 4].targets;
    Complex middle;
    for (const Target& target : wave) middle += target.position / static_cast<double>(wave.size());
    std::vector<HandleTarget> targets;
    for (std::size_t i = 0; i < wave.size(); ++i) {
      const Complex at = middle + spread * (wave[i].position - middle);
      targets.push_back({track_.handles[i].handle.id, {at}});
    }
    return targets;
  }

  client::Session session_;
  PlanarMesh mesh_;
  Track track_;
  int poses_ = 0;
  Film film_;
};

Status DrawDeformations(const client::Client& client, const std::string& folder) {
  const client::CallOptions call{Timeout().value()};
  TRY(const client::Session session, client.CreateSession({}, call));
  Puppet puppet(session);

  puppet.AddRest("handles");
  for (const auto& [mode, label] : {std::pair{DeformMode::kSimilarity, "first step"},
                                    std::pair{DeformMode::kRigid, "second step"}}) {
    CHECK_OK(puppet.AddPose(Basis::kEdgeAsPublished, mode, 1.35, label));
  }
  const Film second = puppet.Take(
      "The first step is free to scale; the second adjusts the scale (edges as published)");
  for (const auto& [basis, label] :
       {std::pair{Basis::kVertex, "vertex"}, std::pair{Basis::kFace, "face"},
        std::pair{Basis::kEdge, "edge"}}) {
    CHECK_OK(puppet.AddPose(basis, DeformMode::kRigid, 1.15, label));
  }
  const Film third = puppet.Take("One pose in the three representations");
  CHECK_OK(session.Delete(call));
  CHECK_OK(WriteTextFile(folder + "/figure2.svg", FormatSheet(second)));
  return WriteTextFile(folder + "/figure3.svg", FormatSheet(third));
}

Status DrawFlattenings(const client::Client& client, const std::string& folder) {
  const SurfaceMesh face = MakeFace(kFaceEdge);
  TRY(const auto panels,
      CompareMethods({}, [&](const client::FlattenQuery& query, const std::string& what) {
        return FlattenWaiting(client, face, query, Timeout().value(), what);
      }));
  return WriteTextFile(
      folder + "/figure6.svg",
      FormatComparison(face, panels,
                       "A face laid flat; the squares have one size on every layout"));
}

Result<Reply> Draw(const FiguresOptions& options) {
  TRY(const Connection connection, Connection::Open(options.server));
  CHECK_OK(DrawDeformations(connection.client(), options.out));
  CHECK_OK(DrawFlattenings(connection.client(), options.out));
  Reply reply;
  for (const char* name : {"figure2.svg", "figure3.svg", "figure6.svg"}) {
    reply.json["files"].push_back(options.out + "/" + name);
  }
  return reply;
}

}  // namespace

void AddFigures(CLI::App& app, Run& run) {
  auto options = std::make_shared<FiguresOptions>();
  CLI::App* const command = app.add_subcommand("figures",
                                               "Draw Figures 2, 3 and 6 of the paper: the two "
                                               "steps, the three representations, flattenings");
  AddServerFlags(*command, options->server);
  command
      ->add_option("--out", options->out, "the folder for figure2.svg, figure3.svg and figure6.svg")
      ->check(CLI::Validator(
          [](std::string& folder) {
            const Status writable = CheckWritable(folder + "/figure2.svg");
            return writable ? std::string() : writable.error().message;
          },
          ""));
  SetReply(*command, run, options, &Draw);
}

}  // namespace arap::cli
