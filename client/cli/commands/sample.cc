// arapctl sample: meshes to try things with, made on the spot.
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/reply.h"
#include "client/cli/sample/samples.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/text_file.h"
#include "core/files/track.h"

namespace arap::cli {
namespace {

struct SampleOptions {
  std::string out;
  std::string track;
  double edge = 0;
  std::size_t size = 20;
  bool json = false;
};

// Writes the files, and answers what is in them.
template <class Mesh>
Result<Reply> Write(const SampleOptions& options, const Mesh& mesh, std::optional<Track> track) {
  CHECK_OK(WriteTextFile(options.out, FormatObj(mesh)));
  Reply reply;
  reply.json = {{"mesh", options.out},
                {"vertices", mesh.vertices.size()},
                {"triangles", mesh.triangles.size()}};
  if (!track || options.track.empty()) return reply;
  track->mesh = std::filesystem::path(options.out).filename().string();
  track->row_weight = 1000;
  CHECK_OK(WriteTextFile(options.track, FormatTrack(*track)));
  reply.json["track"] = options.track;
  reply.json["handles"] = track->handles.size();
  reply.json["frames"] = track->frames.size();
  return reply;
}

Result<Reply> WriteCharacter(const SampleOptions& options) {
  const PlanarMesh mesh = MakeCharacter(options.edge);
  return Write(options, mesh, MakeCharacterTrack(mesh));
}

Result<Reply> WriteGrid(const SampleOptions& options) {
  const PlanarMesh mesh = MakeGrid(options.size, options.size);
  return Write(options, mesh, MakeGridTrack(mesh, options.size, options.size));
}

Result<Reply> WriteGarment(const SampleOptions& options) {
  return Write(options, MakeGarment(options.edge), std::nullopt);
}

Result<Reply> WriteFace(const SampleOptions& options) {
  return Write(options, MakeFace(options.edge), std::nullopt);
}

using Maker = Result<Reply> (*)(const SampleOptions&);

// The options start with the defaults of the sample.
std::pair<CLI::App*, std::shared_ptr<SampleOptions>> AddOne(CLI::App& sample, Run& run,
                                                            const char* name, const char* help,
                                                            Maker make) {
  auto options = std::make_shared<SampleOptions>();
  CLI::App* const command = sample.add_subcommand(name, help);
  AddOutput(*command, "--out", options->out, "write the mesh", "FILE.obj REQUIRED")->required();
  SetReply(*command, run, options, make);
  return {command, options};
}

void AddEdge(CLI::App& command, double& edge, double standard, double least, double most) {
  edge = standard;
  command.add_option("--edge", edge, fmt::format("length of its edges; default {}", standard))
      ->check(CLI::Range(least, most).description(""))
      ->option_text("L");
}

void AddTrack(CLI::App& command, std::string& track) {
  AddOutput(command, "--track", track, "write a track for it", "FILE.json");
}

}  // namespace

void AddSample(CLI::App& app, Run& run) {
  CLI::App* const sample = app.add_subcommand("sample", "Write a sample mesh");
  sample->require_subcommand(1);
  {
    const auto [command, options] =
        AddOne(*sample, run, "character", "a teddy bear in the plane, 200 tall; its track waves",
               &WriteCharacter);
    AddTrack(*command, options->track);
    AddEdge(*command, options->edge, kCharacterEdge, 1, 8);
  }
  {
    const auto [command, options] =
        AddOne(*sample, run, "garment", "the front panel of a skirt in space, in centimetres",
               &WriteGarment);
    AddEdge(*command, options->edge, kGarmentEdge, 0.5, 8);
  }
  {
    const auto [command, options] =
        AddOne(*sample, run, "face", "a bumpy cap in space that is far from flat, in centimetres",
               &WriteFace);
    AddEdge(*command, options->edge, kFaceEdge, 0.2, 2);
  }
  {
    const auto [command, options] = AddOne(*sample, run, "grid", "a square grid", &WriteGrid);
    AddTrack(*command, options->track);
    command->add_option("--size", options->size, "vertices on each side; default 20")
        ->check(CLI::Range(2, 2000).description(""))
        ->option_text("N");
  }
}

}  // namespace arap::cli
