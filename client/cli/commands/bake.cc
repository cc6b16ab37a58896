// arapctl bake: a whole track to shapes.
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/stage.h"
#include "client/cli/patience.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"
#include "core/base/try.h"
#include "core/files/mesh_file.h"

namespace arap::cli {
namespace {

// What the frames amount to.
struct Totals {
  Flips flips;
  double worst_handle_error = 0;
  double max_stretch = 1;
  double solve_micros = 0;

  void Add(const client::Shape& shape) {
    flips.Add(shape.quality);
    worst_handle_error = std::max(worst_handle_error, shape.quality.worst_handle_error);
    if (shape.quality.measured) max_stretch = std::max(max_stretch, shape.quality.max_stretch);
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

// Bakes a track, frame by frame, each to be used when it comes.
class Baker {
 public:
  using OnShape = std::function<Status(std::size_t frame, client::Shape&& shape)>;

  // Refers to both.
  Baker(const Stage& stage, const StageOptions& options)
      : stage_(stage),
        options_(options),
        patience_(options.timeout.value(), [this] { stop_.request_stop(); }) {}

  Result<EditTimes> Edit(const TrackEdit& edit) {
    patience_.Heard();
    const auto edited = stage_.session().EditHandles(
        kHandleSet, edit.remove, ToHandles(stage_.track(), edit.add, options_.hard), Call());
    if (!edited) {
      const auto number = static_cast<std::size_t>(&edit - stage_.track().edits.data());
      return Failed(fmt::format("edit before frame {}: ", edit.frame), edited.error(),
                    {stage_.InTrack("add", "the handle", {"edits", number, "add"}),
                     stage_.InTrack("remove", "the name", {"edits", number, "remove"})});
    }
    PrintWarnings(InOwnWords(edited->handle_set.warnings, stage_.counting()));
    return EditTimes{edit.frame,           edit.remove.size(),   edit.add.size(),
                     edited->queue_micros, edited->solve_micros, 0};
  }

  // The frames of a segment. The first fault of `on_shape` ends it.
  Status Bake(const TrackSegment& segment, const OnShape& on_shape) {
    patience_.Heard();
    Status used;
    std::size_t frame = segment.first;
    const client::ShapeOptions how{options_.deform, /*float64=*/true};
    const Status baked = stage_.session().DeformTrack(kHandleSet, segment.ids,
                                                      FramesOf(stage_.track(), segment), how,
                                                      [&](client::Shape&& shape) {
                                                        patience_.Heard();
                                                        used = on_shape(frame++, std::move(shape));
                                                        return used.has_value();
                                                      },
                                                      {std::nullopt, stop_.get_token()});
    if (!used) return used;
    if (baked) return {};
    return Failed({}, baked.error(),
                  {stage_.InTrack("frames", "the frame", {"frames"}, segment.first)});
  }

 private:
  client::CallOptions Call() const { return {options_.timeout.value(), stop_.get_token()}; }

  tl::unexpected<Fault> Failed(const std::string& when, Fault fault,
                               const std::vector<Origin>& parts) const {
    fault = patience_.Explain(std::move(fault));
    fault.message = when + fault.message;
    fault = InOwnWords(std::move(fault), parts);
    return Fail(InOwnWords(std::move(fault), stage_.Origins()));
  }

  const Stage& stage_;
  const StageOptions& options_;
  std::stop_source stop_;
  Patience patience_;
};

Result<Reply> BakeTrack(const StageOptions& options) {
  TRY(const Stage stage, Stage::Open(options));
  const PlanarMesh& mesh = stage.mesh();
  const Track& track = stage.track();
  ShapesFile shapes(options.out, mesh.vertices.size());
  FilmMaker film(options, stage, /*every=*/true);
  Totals totals;
  std::vector<EditTimes> edits;
  {
    Baker baker(stage, options);
    StatusLine line;
    const auto on_shape = [&](std::size_t frame, client::Shape&& shape) -> Status {
      CHECK_OK(shapes.Write(frame, shape.positions));
      totals.Add(shape);
      film.Add(frame, std::move(shape.positions));
      line.Show(fmt::format("frame {}/{}", totals.flips.frames, track.frames.size()));
      return {};
    };
    TrackSegments segments(track);
    do {
      const TrackSegment& segment = segments.segment();
      if (segment.edit != nullptr) {
        TRY(const EditTimes edited, baker.Edit(*segment.edit));
        edits.push_back(edited);
      }
      CHECK_OK(baker.Bake(segment, on_shape));
    } while (segments.Next());
  }
  CHECK_OK(shapes.Close());
  const double mean_solve =
      totals.flips.frames > 0 ? totals.solve_micros / static_cast<double>(totals.flips.frames) : 0;
  const bool told = totals.flips.are_told();
  const std::string caption = fmt::format(
      "{}, {} vertices, {} triangles, {}; {:.0f} µs per frame; {}; largest stretch {}",
      Numbered(totals.flips.frames, "frame"), mesh.vertices.size(), mesh.triangles.size(),
      Numbered(track.handles.size(), "handle"), mean_solve, Describe(totals.flips),
      told ? fmt::format("{:.3g}", totals.max_stretch) : "not measured");
  Reply answer;
  answer.text = fmt::format(
      "{}\nregistered in {:.1f} ms, compiled in {:.1f} ms, worst handle error {:.3g}\n", caption,
      stage.register_micros() / 1000, stage.compile_micros() / 1000, totals.worst_handle_error);
  answer.json = {{"frames", totals.flips.frames},
                 {"vertices", mesh.vertices.size()},
                 {"triangles", mesh.triangles.size()},
                 {"handles", track.handles.size()},
                 {"mean_solve_micros", mean_solve},
                 {"frames_measured", totals.flips.measured},
                 {"frames_with_flips", told ? OrderedJson(totals.flips.with_flips) : OrderedJson()},
                 {"max_stretch", told ? OrderedJson(totals.max_stretch) : OrderedJson()},
                 {"worst_handle_error", totals.worst_handle_error},
                 {"register_micros", stage.register_micros()},
                 {"compile_micros", stage.compile_micros()},
                 {"edits", OrderedJson::array()}};
  for (const EditTimes& edit : edits) {
    answer.text += Describe(edit) + "\n";
    answer.json["edits"].push_back({{"frame", edit.frame},
                                    {"removed", edit.removed},
                                    {"added", edit.added},
                                    {"queue_micros", edit.queue_micros},
                                    {"solve_micros", edit.solve_micros}});
  }
  CHECK_OK(film.Write(caption));
  return answer;
}

struct BakeOptions : StageOptions {
  bool json = false;
};

Result<Reply> Bake(const BakeOptions& options) { return BakeTrack(options); }

}  // namespace

void AddBake(CLI::App& app, Run& run) {
  auto options = std::make_shared<BakeOptions>();
  CLI::App* const command =
      app.add_subcommand("bake", "Deform a mesh by every frame of a track and write the shapes");
  AddStageOptions(*command, *options, /*out_required=*/true);
  SetReply(*command, run, options, &Bake);
}

}  // namespace arap::cli
