#include "client/src/convert.h"

namespace arap::client::internal {
namespace {

std::chrono::system_clock::time_point FromWire(const google::protobuf::Timestamp& time) {
  const auto since = std::chrono::seconds(time.seconds()) + std::chrono::nanoseconds(time.nanos());
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(since));
}

Distortion FromWire(const v1::Distortion& distortion) {
  Distortion out;
  out.arap_energy = distortion.arap_energy();
  out.symmetric_dirichlet = distortion.symmetric_dirichlet();
  out.area_ratio = distortion.area_ratio();
  out.mean_stretch_percent = distortion.mean_stretch_percent();
  out.max_stretch_percent = distortion.max_stretch_percent();
  out.mean_compression_percent = distortion.mean_compression_percent();
  out.max_compression_percent = distortion.max_compression_percent();
  out.mean_angle_degrees = distortion.mean_angle_degrees();
  out.max_angle_degrees = distortion.max_angle_degrees();
  out.flipped = distortion.flipped();
  out.scale = distortion.scale();
  return out;
}

Limits FromWire(const v1::Limits& limits) {
  Limits out;
  out.max_vertices = limits.max_vertices();
  out.max_triangles = limits.max_triangles();
  out.max_handles = limits.max_handles();
  out.max_sessions = limits.max_sessions();
  out.max_meshes_per_session = limits.max_meshes_per_session();
  out.max_handle_sets_per_session = limits.max_handle_sets_per_session();
  out.max_message_bytes = limits.max_message_bytes();
  out.max_refine = limits.max_refine();
  out.max_ttl = internal::FromWire(limits.max_ttl());
  out.max_streams = limits.max_streams();
  out.max_track_frames = limits.max_track_frames();
  return out;
}

}  // namespace

SessionInfo FromWire(const v1::Session& session) {
  SessionInfo out;
  out.id = session.session_id();
  out.create_time = FromWire(session.create_time());
  out.expire_time = FromWire(session.expire_time());
  out.ttl = FromWire(session.ttl());
  out.labels.insert(session.labels().begin(), session.labels().end());
  out.mesh_ids.assign(session.mesh_ids().begin(), session.mesh_ids().end());
  out.handle_set_ids.assign(session.handle_set_ids().begin(), session.handle_set_ids().end());
  return out;
}

void ToWire(const FlattenOptions& options, v1::FlattenRequest* out) {
  ToWire(options.energy, out->mutable_energy());
  out->set_refine(options.refine);
  out->set_include_first_step(options.first_step);
  out->set_include_singular_values(options.singular_values);
  out->set_float64(options.float64);
  Append(std::span(options.seam_edges), out->mutable_seam_edges());
}

FlatSurface FromWire(const v1::FlattenResponse& response) {
  FlatSurface out;
  out.uv =
      response.uv64_size() > 0 ? Values<double>(response.uv64()) : Values<double>(response.uv());
  out.uv_vertex = Values<std::uint32_t>(response.uv_vertex());
  out.corner_uv = Values<std::uint32_t>(response.corner_uv());
  out.first_step_uv = Values<double>(response.first_step_uv());
  out.singular_values = Values<double>(response.singular_values());
  out.distortion = FromWire(response.distortion());
  out.warnings = FromWire(response.warnings());
  out.anchor_vertices = Values<std::uint32_t>(response.anchor_vertices());
  out.queue_micros = Micros(response.queue_time());
  out.solve_micros = Micros(response.solve_time());
  return out;
}

ServerInfo FromWire(const v1::GetServerInfoResponse& response) {
  ServerInfo out;
  out.version = response.version();
  out.limits = FromWire(response.limits());
  out.capabilities.assign(response.capabilities().begin(), response.capabilities().end());
  out.workers = response.workers();
  return out;
}

}  // namespace arap::client::internal
