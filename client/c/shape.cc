// Shapes and tracks for C.
#include <algorithm>
#include <cstdint>
#include <utility>

#include "client/c/objects.h"

using arap::Status;
using arap::c::Guard;
using arap::c::Need;
namespace client = arap::client;

namespace arap::c {
namespace {

Result<client::DeformMode> ModeOf(std::int32_t mode) {
  switch (mode) {
    case ARAP_MODE_DEFAULT:
    case ARAP_MODE_RIGID:
      return client::DeformMode::kRigid;
    case ARAP_MODE_SIMILARITY:
      return client::DeformMode::kSimilarity;
    case ARAP_MODE_BASELINE:
      return client::DeformMode::kBaseline;
    default:
      return Fail(BadChoice("mode", "is no mode", mode));
  }
}

Result<client::PositionEncoding> EncodingOf(std::int32_t encoding) {
  switch (encoding) {
    case ARAP_ENCODING_DEFAULT:
    case ARAP_FLOAT32:
      return client::PositionEncoding::kFloat32;
    case ARAP_FLOAT32_LE:
      return client::PositionEncoding::kFloat32Le;
    case ARAP_INT16_LE:
      return client::PositionEncoding::kInt16Le;
    default:
      return Fail(BadChoice("encoding", "is no encoding", encoding));
  }
}

// Every frame of a track, in the order of the handles.
Result<std::vector<std::vector<Target>>> FramesOf(const double* positions, const double* turns,
                                                  std::size_t frames, std::size_t handles) {
  if (handles > 0 && frames > SIZE_MAX / handles) {
    return Fail(Bad("positions", "positions cannot have so many elements."));
  }
  CHECK_OK(ArrayOf(positions, frames * handles, "positions"));
  std::vector<std::vector<Target>> ours(frames, std::vector<Target>(handles));
  std::size_t next = 0;
  for (std::vector<Target>& frame : ours) {
    for (Target& target : frame) {
      target.position = {positions[next], positions[next + 1]};
      if (turns != nullptr) {
        target.angle = turns[next];
        target.scale = turns[next + 1];
      }
      next += 2;
    }
  }
  return ours;
}

}  // namespace

Result<std::vector<client::HandleTarget>> TargetsOf(const arap_target* targets, std::size_t count) {
  TRY(const auto given, ArrayOf(targets, count, "targets"));
  std::vector<client::HandleTarget> ours;
  ours.reserve(count);
  for (const arap_target& target : given) {
    TRY(auto id, IdOf(target.handle_id, Member("targets", ours.size(), "handle_id").c_str()));
    ours.push_back({std::move(id), {{target.x, target.y}, target.angle, target.scale}});
  }
  return ours;
}

Result<client::ShapeOptions> ShapeOptionsOf(const arap_shape_options* options, const char* field) {
  TRY(const auto given, OptionsOf(options, field));
  client::ShapeOptions ours;
  TRY(ours.deform.mode, ModeOf(given.mode));
  if (given.refine < 0) return Fail(Bad("refine", "refine is below 0."));
  ours.deform.refine = given.refine;
  ours.float64 = given.float64 != 0;
  ours.flipped_ids = given.flipped_ids != 0;
  TRY(ours.encoding, EncodingOf(given.encoding));
  ours.boundary_only = given.boundary_only != 0;
  TRY(const auto subset, ArrayOf(given.vertex_subset, given.vertex_subset_count, "vertex_subset"));
  ours.vertex_subset.assign(subset.begin(), subset.end());
  if (given.measure_every != 0) {
    ours.deform.measure_every = static_cast<std::uint32_t>(std::max(given.measure_every, 0));
  }
  return ours;
}

}  // namespace arap::c

extern "C" {

size_t arap_shape_vertex_count(const arap_shape* shape) { return shape->shape.positions.size(); }
const double* arap_shape_positions(const arap_shape* shape) {
  return arap::c::Doubles(shape->shape.positions);
}
const uint32_t* arap_shape_vertices(const arap_shape* shape) {
  return shape->shape.vertices.empty() ? nullptr : shape->shape.vertices.data();
}
double arap_shape_position_error(const arap_shape* shape) { return shape->shape.position_error; }
arap_quality arap_shape_quality(const arap_shape* shape) {
  const client::ShapeQuality& quality = shape->shape.quality;
  return {quality.flipped, quality.worst_handle_error, quality.energy, quality.mean_stretch,
          quality.max_stretch};
}
int32_t arap_shape_is_measured(const arap_shape* shape) {
  return shape->shape.quality.measured ? 1 : 0;
}
const char* arap_shape_worst_handle(const arap_shape* shape) {
  return shape->shape.worst_handle_id.c_str();
}
size_t arap_shape_flipped_count(const arap_shape* shape) { return shape->shape.flipped_ids.size(); }
const uint32_t* arap_shape_flipped(const arap_shape* shape) {
  return shape->shape.flipped_ids.data();
}
size_t arap_shape_pick_count(const arap_shape* shape) { return shape->shape.picks.size(); }
arap_pick arap_shape_pick(const arap_shape* shape, size_t index) {
  const auto& picks = shape->shape.picks;
  if (index >= picks.size() || !picks[index]) return {};
  const client::Pick& pick = *picks[index];
  return {1,
          pick.triangle,
          {pick.barycentric[0], pick.barycentric[1], pick.barycentric[2]},
          pick.rest.real(),
          pick.rest.imag()};
}
uint64_t arap_shape_sequence(const arap_shape* shape) { return shape->shape.sequence; }
uint64_t arap_shape_replaced(const arap_shape* shape) { return shape->shape.replaced; }
uint64_t arap_shape_revision(const arap_shape* shape) { return shape->shape.handle_set_revision; }
void arap_shape_free(arap_shape* shape) { delete shape; }

arap_error* arap_deform(const arap_session* session, const char* handle_set_id,
                        const arap_target* targets, size_t target_count,
                        const arap_shape_options* options, const arap_call_options* call,
                        arap_shape** out) {
  return arap_deform_and_pick(session, handle_set_id, targets, target_count, nullptr, 0, options,
                              call, out);
}

arap_error* arap_deform_and_pick(const arap_session* session, const char* handle_set_id,
                                 const arap_target* targets, size_t target_count,
                                 const double* points, size_t point_count,
                                 const arap_shape_options* options, const arap_call_options* call,
                                 arap_shape** out) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    CHECK_OK(Need(out, "out"));
    TRY(const auto id, arap::c::IdOf(handle_set_id, "handle_set_id"));
    TRY(const auto ours, arap::c::TargetsOf(targets, target_count));
    TRY(const auto picked, arap::c::PointsOf(points, point_count, "points"));
    TRY(const auto shaping, arap::c::ShapeOptionsOf(options, "options"));
    TRY(const auto calling, arap::c::CallOf(call));
    TRY(auto shape, session->session.Deform(id, ours, shaping, picked, calling));
    *out = new arap_shape{std::move(shape)};
    return {};
  });
}

arap_error* arap_deform_track(const arap_session* session, const char* handle_set_id,
                              const char* const* handle_ids, size_t handle_count,
                              const double* positions, const double* turns, size_t frame_count,
                              const arap_shape_options* options, arap_frame_callback on_frame,
                              void* user, const arap_call_options* call) {
  return Guard([&]() -> Status {
    CHECK_OK(Need(session, "session"));
    if (on_frame == nullptr) return Fail(arap::c::Bad("on_frame", "on_frame is NULL."));
    TRY(const auto id, arap::c::IdOf(handle_set_id, "handle_set_id"));
    TRY(const auto handles, arap::c::IdsOf(handle_ids, handle_count, "handle_ids"));
    TRY(const auto frames, arap::c::FramesOf(positions, turns, frame_count, handle_count));
    TRY(const auto shaping, arap::c::ShapeOptionsOf(options, "options"));
    TRY(const auto calling, arap::c::CallOf(call));
    const auto give = [&](client::Shape&& shape) {
      const arap_shape ours{std::move(shape)};
      return on_frame(user, &ours) != 0;
    };
    return session->session.DeformTrack(id, handles, frames, shaping, give, calling);
  });
}

}  // extern "C"
