// What the server is and what it allows.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace arap::client {

// The limits in force. A request beyond one fails with a fault that names it.
struct Limits {
  std::uint64_t max_vertices = 0;
  std::uint64_t max_triangles = 0;
  std::uint64_t max_handles = 0;
  std::uint64_t max_sessions = 0;
  std::uint64_t max_meshes_per_session = 0;
  std::uint64_t max_handle_sets_per_session = 0;
  std::uint64_t max_message_bytes = 0;
  std::uint32_t max_refine = 0;
  std::chrono::nanoseconds max_ttl{0};
  std::uint64_t max_streams = 0;
  std::uint64_t max_track_frames = 0;
  std::uint64_t max_flatten_triangles = 0;
  std::uint64_t max_cached_surfaces = 0;
  std::uint64_t max_cached_surface_bytes = 0;
  // Of one owner, unless its token carries other numbers.
  std::uint64_t max_sessions_per_owner = 0;
  std::uint64_t max_meshes_per_owner = 0;
  std::uint64_t max_handle_sets_per_owner = 0;
  std::uint64_t max_bytes_per_owner = 0;
  std::uint64_t max_streams_per_owner = 0;
  std::uint64_t max_bytes = 0;
  std::uint64_t max_registrations = 0;
  std::uint64_t max_compilations = 0;
  std::uint64_t max_flattenings = 0;
  std::uint64_t max_queued_jobs = 0;
  double max_stream_fps = 0;
  std::chrono::nanoseconds max_stream_idle{0};
  double max_stream_load = 0;
};

struct ServerInfo {
  std::string version;  // semantic version
  Limits limits;
  std::vector<std::string> capabilities;  // names such as "basis.edge"
  std::uint32_t workers = 0;              // worker threads
};

}  // namespace arap::client
