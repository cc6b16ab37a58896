#include "client/src/convert.h"

namespace arap::client::internal {
namespace {

std::chrono::system_clock::time_point FromWire(const google::protobuf::Timestamp& time) {
  const auto since = std::chrono::seconds(time.seconds()) + std::chrono::nanoseconds(time.nanos());
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(since));
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
  out.max_flatten_triangles = limits.max_flatten_triangles();
  out.max_cached_surfaces = limits.max_cached_surfaces();
  out.max_cached_surface_bytes = limits.max_cached_surface_bytes();
  out.max_sessions_per_owner = limits.max_sessions_per_owner();
  out.max_meshes_per_owner = limits.max_meshes_per_owner();
  out.max_handle_sets_per_owner = limits.max_handle_sets_per_owner();
  out.max_bytes_per_owner = limits.max_bytes_per_owner();
  out.max_streams_per_owner = limits.max_streams_per_owner();
  out.max_bytes = limits.max_bytes();
  out.max_registrations = limits.max_registrations();
  out.max_compilations = limits.max_compilations();
  out.max_flattenings = limits.max_flattenings();
  out.max_queued_jobs = limits.max_queued_jobs();
  out.max_stream_fps = limits.max_stream_fps();
  out.max_stream_idle = internal::FromWire(limits.max_stream_idle());
  out.max_stream_load = limits.max_stream_load();
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

ServerInfo FromWire(const v1::GetServerInfoResponse& response) {
  ServerInfo out;
  out.version = response.version();
  out.limits = FromWire(response.limits());
  out.capabilities.assign(response.capabilities().begin(), response.capabilities().end());
  out.workers = response.workers();
  return out;
}

}  // namespace arap::client::internal
