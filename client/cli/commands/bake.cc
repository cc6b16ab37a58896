// arapctl bake: a whole track to shapes.
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/stage.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/shapes.h"

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
    if (shape.quality.flipped > 0) ++frames_with_flips;
    worst_handle_error = std::max(worst_handle_error, shape.quality.worst_handle_error);
    max_stretch = std::max(max_stretch, shape.quality.max_stretch);
    solve_micros += shape.solve_micros;
  }
};

std::vector<std::vector<Target>> FramesOf(const Track& track, const TrackSegment& segment) {
  std::vector<std::vector<Target>> frames;
  for (std::size_t i = segment.first; i < segment.end; ++i) {
    frames.push_back(track.frames[i].targets);
  }
  return frames;
}

Result<EditTimes> Edit(const Stage& stage, const TrackEdit& edit, bool hard) {
  const auto edited = stage.session().EditHandles(kHandleSet, edit.remove,
                                                  ToHandles(stage.track(), edit.add, hard));
  if (!edited) {
    Fault fault = edited.error();
    fault.message = fmt::format("edit before frame {}: {}", edit.frame, fault.message);
    return Fail(std::move(fault));
  }
  PrintWarnings(edited->handle_set.warnings);
  return EditTimes{edit.frame,           edit.remove.size(),   edit.add.size(),
                   edited->queue_micros, edited->solve_micros, 0};
}

// Bakes the frames of a segment; `on_shape` gets their numbers in the track.
Status BakeSegment(const Stage& stage, const TrackSegment& segment, const client::ShapeOptions& how,
                   const std::function<void(std::size_t, const client::Shape&)>& on_shape) {
  Status baked =
      stage.session().DeformTrack(kHandleSet, segment.ids, FramesOf(stage.track(), segment), how,
                                  [&](const client::Shape& shape) {
                                    on_shape(segment.first + shape.sequence, shape);
                                    return true;
                                  });
  if (!baked && segment.first > 0) {
    Fault& fault = baked.error();
    fault.message = fmt::format("counted from frame {}: {}", segment.first, fault.message);
  }
  return baked;
}

Status Bake(const StageOptions& options) {
  TRY(const Stage stage, Stage::Open(options));
  const PlanarMesh& mesh = stage.mesh();
  const Track& track = stage.track();
  ShapesFile shapes(options.out, mesh.vertices.size());
  FilmMaker film(options, stage);
  Totals totals;
  std::vector<EditTimes> edits;
  const client::ShapeOptions how{options.deform, /*float64=*/true};
  {
    Progress progress("frame", track.frames.size());
    for (const TrackSegment& segment : SegmentsOf(track)) {
      if (segment.edit != nullptr) {
        TRY(const EditTimes edited, Edit(stage, *segment.edit, options.hard));
        edits.push_back(edited);
      }
      CHECK_OK(BakeSegment(stage, segment, how, [&](std::size_t frame, const client::Shape& shape) {
        shapes.Write(frame, shape.positions);
        film.Add(frame, shape);
        totals.Add(shape);
        progress.Step();
      }));
    }
  }
  CHECK_OK(shapes.Close());
  const double mean_solve =
      totals.frames > 0 ? totals.solve_micros / static_cast<double>(totals.frames) : 0;
  const std::string caption = fmt::format(
      "{} frames, {} vertices, {} triangles, {} handles; {:.0f} µs per frame; {} frames with "
      "flips; largest stretch {:.3g}",
      totals.frames, mesh.vertices.size(), mesh.triangles.size(), track.handles.size(), mean_solve,
      totals.frames_with_flips, totals.max_stretch);
  fmt::print("{}\nregistered in {:.1f} ms, compiled in {:.1f} ms, worst handle error {:.3g}\n",
             caption, stage.register_micros() / 1000, stage.compile_micros() / 1000,
             totals.worst_handle_error);
  for (const EditTimes& edit : edits) fmt::print("{}\n", Describe(edit));
  return film.Write(caption);
}

}  // namespace

void AddBake(CLI::App& app, Run& run) {
  auto options = std::make_shared<StageOptions>();
  CLI::App* const command =
      app.add_subcommand("bake", "Deform a mesh by every frame of a track and write the shapes");
  AddStageOptions(*command, *options, /*out_required=*/true);
  SetAction(*command, run, options, &Bake);
}

}  // namespace arap::cli
