// Limits: every quota of the server with its default. Each is a flag of arapd and a field of
// GetServerInfo, and an answer that refuses a request names the one that it ran into.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace arap::app {

// What one owner may have. A token may carry its own numbers.
struct OwnerLimits {
  std::size_t max_sessions = 1'000;
  std::size_t max_meshes = 4'000;                 // registered, in all sessions together
  std::size_t max_handle_sets = 16'000;           // likewise
  std::size_t max_bytes = std::size_t{4} << 30u;  // of factors and tables in memory
  std::size_t max_streams = 256;                  // open streams and running tracks

  bool operator==(const OwnerLimits&) const = default;
};

struct Limits {
  OwnerLimits owner;
  std::size_t max_sessions = 10'000;
  std::size_t max_meshes_per_session = 16;
  std::size_t max_handle_sets_per_session = 64;
  std::size_t max_vertices = 1'000'000;
  std::size_t max_triangles = 2'000'000;
  std::size_t max_handles = 1'000;             // of one handle set
  std::size_t max_message_bytes = 64u << 20u;  // of one request message
  std::size_t max_streams = 1'000;             // open streams and running tracks together
  std::size_t max_track_frames = 10'000;
  std::uint32_t max_refine = 1000;
  std::size_t max_flatten_triangles = 2'000'000;
  std::size_t max_cached_surfaces = 64;  // kept under a surface_key, 0 for none
  std::size_t max_cached_surface_bytes = 1u << 30u;
  std::size_t max_bytes = std::size_t{8} << 30u;  // of factors and tables in memory, of all owners
  std::size_t max_registrations = 64;             // running and waiting, likewise the next two
  std::size_t max_compilations = 256;             // edits too
  std::size_t max_flattenings = 64;
  double max_stream_fps = 10'000;  // updates a second on one stream, 0: any number
  double max_stream_load = 0.5;    // part of the interactive lane's time, 0: any
  std::chrono::milliseconds max_stream_idle = std::chrono::minutes(10);
  std::chrono::milliseconds idle_evict = std::chrono::minutes(10);  // of what can be computed again
  std::chrono::milliseconds default_ttl = std::chrono::hours(1);
  std::chrono::milliseconds max_ttl = std::chrono::hours(24);
};

inline constexpr std::chrono::milliseconds kMinTtl = std::chrono::seconds(1);
inline constexpr std::size_t kMaxLabels = 16;
inline constexpr std::size_t kMaxLabelBytes = 128;
inline constexpr std::size_t kDefaultPageSize = 100;
inline constexpr std::size_t kMaxPageSize = 1'000;

}  // namespace arap::app
