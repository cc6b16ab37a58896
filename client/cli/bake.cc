// arapctl bake: a whole track to shapes.
#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands.h"
#include "client/cli/report.h"
#include "client/cli/shapes_file.h"
#include "client/cli/stage.h"

namespace arap::cli {
namespace {

// What the frames amount to.
struct Totals {
  std::size_t frames = 0;
  std::size_t frames_with_flips = 0;
  double worst_handle_error = 0;
  double max_stretch = 1;
  double solve_micros = 0;

  void Add(const client::Shape& shape) {
    ++frames;
    if (shape.flipped_count > 0) ++frames_with_flips;
    worst_handle_error = std::max(worst_handle_error, shape.worst_handle_error);
    max_stretch = std::max(max_stretch, shape.max_stretch);
    solve_micros += shape.solve_micros;
  }
};

std::vector<client::TrackFrame> Frames(const Track& track) {
  std::vector<client::TrackFrame> frames;
  for (const TrackFrame& frame : track.frames)
    frames.push_back({frame.targets, frame.angles, frame.scales});
  return frames;
}

Status Bake(const StageOptions& options) {
  const Result<Stage> stage = Stage::Open(options);
  if (!stage) return Fail(stage.error());
  const client::PlanarMesh& mesh = stage->mesh();
  ShapesFile shapes(options.out, mesh.vertex_count());
  FilmMaker film(options, *stage);
  Totals totals;
  client::DeformOptions deform = options.deform;
  deform.float64 = true;
  Status baked;
  {
    Progress progress("frame", stage->track().frames.size());
    baked =
        stage->session().DeformTrack(kHandleSet, HandleIds(stage->track()), Frames(stage->track()),
                                     deform, [&](client::Shape&& shape) {
                                       shapes.Write(shape.sequence, shape.positions);
                                       film.Add(shape.sequence, shape);
                                       totals.Add(shape);
                                       progress.Step();
                                       return true;
                                     });
  }
  if (!baked) return baked;
  if (Status closed = shapes.Close(); !closed) return closed;
  const double mean_solve =
      totals.frames > 0 ? totals.solve_micros / static_cast<double>(totals.frames) : 0;
  const std::string caption = fmt::format(
      "{} frames, {} vertices, {} triangles, {} handles; {:.0f} µs per frame; {} frames with "
      "flips; "
      "largest stretch {:.3g}",
      totals.frames, mesh.vertex_count(), mesh.triangle_count(), stage->track().handles.size(),
      mean_solve, totals.frames_with_flips, totals.max_stretch);
  fmt::print("{}\nregistered in {:.1f} ms, compiled in {:.1f} ms, worst handle error {:.3g}\n",
             caption, stage->register_micros() / 1000, stage->compile_micros() / 1000,
             totals.worst_handle_error);
  return film.Write(caption);
}

}  // namespace

void AddBake(CLI::App& app, Run& run) {
  auto options = std::make_shared<StageOptions>();
  CLI::App* const command =
      app.add_subcommand("bake", "Deform a mesh by every frame of a track and write the shapes");
  AddStageOptions(*command, *options, /*out_required=*/true);
  command->callback([options, &run] {
    run = [options] {
      const Status baked = Bake(*options);
      return baked ? kOk : Complain(baked.error());
    };
  });
}

}  // namespace arap::cli
