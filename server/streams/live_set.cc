#include "server/streams/live_set.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "arap/core/cost.h"
#include "arap/core/pick.h"
#include "core/base/try.h"
#include "core/mesh/locate.h"
#include "server/runtime/clock.h"
#include "server/runtime/helpers.h"
#include "server/runtime/metrics.h"
#include "server/streams/admission.h"
#include "server/streams/targets.h"

namespace arap::app {
namespace {

using Corners = std::array<Complex, 3>;

Corners CornersOf(std::span<const Complex> points, const Triangle& triangle) {
  return {points[triangle[0]], points[triangle[1]], points[triangle[2]]};
}

// The a of the similarity z → a z + b that maps `rest` to `now` best.
Complex Similarity(const Corners& rest, const Corners& now) {
  const Complex rest_middle = (rest[0] + rest[1] + rest[2]) / 3.0;
  const Complex now_middle = (now[0] + now[1] + now[2]) / 3.0;
  Complex product = 0;
  double norm = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    product += std::conj(rest[i] - rest_middle) * (now[i] - now_middle);
    norm += std::norm(rest[i] - rest_middle);
  }
  return product / norm;
}

// Of a handle on this triangle.
Target PoseOf(const PlanarMesh& mesh, const PlacedHandle& handle,
              std::optional<std::uint32_t> triangle, std::span<const Complex> positions) {
  if (!triangle) return {handle.rest, 0, 1};
  const Corners rest = CornersOf(mesh.vertices, mesh.triangles[*triangle]);
  const Corners now = CornersOf(positions, mesh.triangles[*triangle]);

  Target pose;
  if (const auto* vertex = std::get_if<VertexAnchor>(&handle.handle.anchor)) {
    pose.position = positions[vertex->vertex];
  } else {
    const auto weights = Barycentric(rest, handle.rest);
    pose.position = weights[0] * now[0] + weights[1] * now[1] + weights[2] * now[2];
  }
  const Complex similarity = Similarity(rest, now);
  const double scale = std::abs(similarity);
  if (scale > 0 && scale <= Target::kMaxScale) {
    pose.angle = std::arg(similarity);
    pose.scale = scale;
  }
  return pose;
}

// Who helps with a frame in this thread: whoever has nothing to do, with a frame that is a job for its length.
bool IsHelped(const CompiledHandles& handles, const DeformOptions& options) {
  return EstimateFrame(handles, options).seconds() > kLongFrameSeconds;
}
Crew* CrewFor(const CompiledHandles& handles, const DeformOptions& options,
              runtime::Helpers& helpers) {
  // Most frames run where there are no helpers: they need no estimate.
  Crew* const crew = helpers.crew();
  return crew != nullptr && IsHelped(handles, options) ? crew : nullptr;
}

}  // namespace

std::vector<Target> PosesOf(const RegisteredMesh& mesh, std::span<const PlacedHandle> handles,
                            std::span<const Complex> positions) {
  const auto triangles = TrianglesUnder(mesh, handles);
  std::vector<Target> poses;
  poses.reserve(handles.size());
  for (std::size_t i = 0; i < handles.size(); ++i) {
    poses.push_back(PoseOf(mesh.mesh(), handles[i], triangles[i], positions));
  }
  return poses;
}

LiveSet::LiveSet(HandleSetEntry entry, std::size_t lanes)
    : entry_(std::move(entry)), deformer_(entry_.handles, lanes) {}

std::size_t LiveSet::BytesOf(const CompiledHandles& handles, const DeformOptions& options,
                             std::size_t lanes) {
  const std::size_t vertices = handles.mesh()->mesh().vertices.size();
  return DeformerBytes(handles, lanes, IsHelped(handles, options)) +
         3 * lanes * vertices * 2 * sizeof(double);
}

Result<ShapeQuality> LiveSet::Move(std::span<const Target> targets, const DeformOptions& options,
                                   runtime::Metrics& metrics, const CancelToken& cancel) {
  const runtime::WallTimer working;
  helped_seconds_ = 0;
  runtime::Helpers helpers;
  Crew* crew = CrewFor(*entry_.handles, options, helpers);
  auto quality = deformer_.Update(targets, options, cancel, crew);
  helped_seconds_ = helpers.seconds();
  if (!quality) return quality;
  metrics.Phase(runtime::Phase::kFrame, working.Micros() * 1e-6);
  return quality;
}

Status LiveSet::MoveMany(std::span<const std::span<const Target>> targets,
                         const DeformOptions& options, std::span<ShapeQuality> qualities,
                         std::size_t first, runtime::Metrics& metrics, const CancelToken& cancel) {
  const runtime::WallTimer working;
  runtime::Helpers helpers;
  Crew* crew = CrewFor(*entry_.handles, options, helpers);
  CHECK_OK(deformer_.UpdateMany(targets, options, qualities, cancel, first, crew));
  const double each = working.Micros() * 1e-6 / static_cast<double>(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) metrics.Phase(runtime::Phase::kTrack, each);
  return {};
}

double LiveSet::MoveTogether(JointFrame& one, JointFrame& other, runtime::Metrics& metrics) {
  const runtime::WallTimer working;
  runtime::Helpers helpers;
  Crew* crew = CrewFor(*one.deformer.handles(), one.options, helpers);
  const auto moved = OrOutOfMemory([&]() -> Status {
    UpdateTogether(one, other, crew);
    return {};
  });
  for (JointFrame* frame : {&one, &other}) {
    // The memory that one lacks is no fault of the other's.
    if (!moved) {
      frame->quality = OrOutOfMemory(
          [&] { return frame->deformer.Update(frame->targets, frame->options, frame->cancel); });
    }
    if (frame->quality) metrics.Phase(runtime::Phase::kFrame, working.Micros() * 1e-6 / 2);
  }
  return helpers.seconds();
}

Result<EditedSet> LiveSet::Edited(const std::vector<std::string>& remove,
                                  const std::vector<Handle>& add, std::span<const Target> targets,
                                  const DeformOptions& options, const Limits& limits,
                                  const CancelToken& cancel, runtime::Metrics& metrics) const {
  const runtime::WallTimer working;
  TRY(auto entry, EditEntry(entry_, remove, add, limits, cancel));
  EditedSet edited{LiveSet(std::move(entry)), {}, {}};

  const CompiledHandles& before = *entry_.handles;
  const std::vector<PlacedHandle>& placed = edited.set.entry().handles->handles();
  const std::size_t kept = placed.size() - add.size();
  edited.targets.reserve(placed.size());
  for (std::size_t i = 0; i < kept; ++i) {
    edited.targets.push_back(targets[*before.Find(placed[i].handle.id)]);
  }
  const auto added =
      PosesOf(*before.mesh(), std::span(placed).subspan(kept), deformer_.positions());
  edited.targets.insert(edited.targets.end(), added.begin(), added.end());
  DeformOptions measured = options;
  measured.measure_every = 1;
  runtime::Helpers helpers;
  Crew* crew = CrewFor(*edited.set.entry().handles, options, helpers);
  TRY(edited.quality, edited.set.deformer_.Update(edited.targets, measured, cancel, crew));
  metrics.Phase(runtime::Phase::kEdit, working.Micros() * 1e-6);
  return edited;
}

}  // namespace arap::app
