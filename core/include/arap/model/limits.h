// Limits: what a server refuses to exceed, with defaults, and the one table that names them.
//
// A new limit is a member of Limits, a row of kLimits, a field of arap.v1.Limits of the same name
// (unless it is not served) and a row in docs/operations.md. Flags, environment, the config file,
// GetServerInfo, tokens and `arapctl info` read the table.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "arap/model/deform.h"

namespace arap {

// What one owner may have. A token may carry its own numbers.
struct OwnerLimits {
  std::size_t max_sessions = 1'000;
  std::size_t max_meshes = 4'000;
  std::size_t max_handle_sets = 16'000;
  std::size_t max_bytes = std::size_t{4} << 30u;
  std::size_t max_streams = 256;
  std::size_t max_stored_bytes = std::size_t{16} << 30u;

  bool operator==(const OwnerLimits&) const = default;
};

// Their meanings are in kLimits.
struct Limits {
  OwnerLimits owner = {};
  std::size_t max_sessions = 10'000;
  std::size_t max_meshes_per_session = 16;
  std::size_t max_handle_sets_per_session = 64;
  std::size_t max_vertices = 1'000'000;
  std::size_t max_triangles = 2'000'000;
  std::size_t max_handles = 1'000;
  std::size_t max_message_bytes = 64u << 20u;
  std::size_t max_streams = 1'000;
  std::size_t max_track_frames = 10'000;
  std::uint32_t max_refine = kMaxRefine;
  std::size_t max_flatten_triangles = 2'000'000;
  std::size_t max_cached_surfaces = 64;
  std::size_t max_cached_surface_bytes = 1u << 30u;
  std::size_t max_bytes = std::size_t{8} << 30u;
  std::size_t max_registrations = 64;
  std::size_t max_compilations = 256;
  std::size_t max_flattenings = 64;
  std::size_t max_queued_jobs = 256;
  double max_stream_fps = 10'000;
  double max_stream_load = 0.5;
  std::chrono::milliseconds max_stream_idle = std::chrono::minutes(10);
  std::chrono::milliseconds idle_evict = std::chrono::minutes(10);
  std::chrono::milliseconds default_ttl = std::chrono::hours(1);
  std::chrono::milliseconds max_ttl = std::chrono::hours(24);

  bool operator==(const Limits&) const = default;
};

using LimitMember = std::variant<std::size_t Limits::*, std::uint32_t Limits::*, double Limits::*,
                                 std::chrono::milliseconds Limits::*, std::size_t OwnerLimits::*>;

struct LimitInfo {
  std::string_view name;  // on the wire, and in the refusals that it leads to
  LimitMember member;
  std::string_view meaning;
  // What a flag takes; of times, in seconds.
  double smallest = 0;
  double largest = 1e9;
  bool served = true;          // by GetServerInfo
  std::string_view flag = {};  // where it is not the name with dashes
};

inline constexpr double kMaxLimitBytes = 1e15;

inline constexpr LimitInfo kLimits[] = {
    {"max_sessions", &Limits::max_sessions, "Sessions on this server"},
    {"max_meshes_per_session", &Limits::max_meshes_per_session, "Meshes of one session"},
    {"max_handle_sets_per_session", &Limits::max_handle_sets_per_session,
     "Handle sets of one session"},
    {"max_vertices", &Limits::max_vertices, "Vertices of one mesh"},
    {"max_triangles", &Limits::max_triangles, "Triangles of one mesh"},
    {"max_handles", &Limits::max_handles, "Handles of one handle set"},
    {"max_message_bytes", &Limits::max_message_bytes, "Bytes of one request message"},
    {"max_streams", &Limits::max_streams, "Open streams and running tracks"},
    {"max_track_frames", &Limits::max_track_frames, "Frames of one track"},
    {"max_refine", &Limits::max_refine, "Refinement iterations of one update", 0, kMaxRefine},
    {"max_flatten_triangles", &Limits::max_flatten_triangles, "Triangles of one flattening"},
    {"max_cached_surfaces", &Limits::max_cached_surfaces,
     "Surfaces kept under a surface_key, 0 for none"},
    {"max_cached_surface_bytes", &Limits::max_cached_surface_bytes,
     "Bytes that the surfaces kept take together", 0, kMaxLimitBytes},
    {"max_bytes", &Limits::max_bytes, "Bytes of factors and tables in memory, of all owners", 0,
     kMaxLimitBytes},
    {"max_registrations", &Limits::max_registrations, "Registrations that run or wait"},
    {"max_compilations", &Limits::max_compilations, "Compilations and edits that run or wait"},
    {"max_flattenings", &Limits::max_flattenings, "Flattenings that run or wait"},
    {"max_queued_jobs", &Limits::max_queued_jobs, "Jobs that may wait, of each kind of worker", 1,
     1e6, true, "queue"},
    {"max_stream_fps", &Limits::max_stream_fps, "Updates a second on one stream, 0 for any number"},
    {"max_stream_load", &Limits::max_stream_load,
     "Part of the time of --workers that admitted streams may take, 0 for any", 0, 1},
    {"max_sessions_per_owner", &OwnerLimits::max_sessions, "Sessions of one owner"},
    {"max_meshes_per_owner", &OwnerLimits::max_meshes, "Meshes of one owner, in all sessions"},
    {"max_handle_sets_per_owner", &OwnerLimits::max_handle_sets,
     "Handle sets of one owner, in all sessions"},
    {"max_bytes_per_owner", &OwnerLimits::max_bytes, "Bytes of factors and tables of one owner", 0,
     kMaxLimitBytes},
    {"max_streams_per_owner", &OwnerLimits::max_streams, "Open streams and tracks of one owner"},
    {"max_stored_bytes_per_owner", &OwnerLimits::max_stored_bytes,
     "Bytes of one owner in the store: records and the meshes that they name", 0, kMaxLimitBytes},
    {"default_ttl", &Limits::default_ttl,
     "How long a session lives without use, unless it says so itself", 1, 1e9, false},
    {"max_ttl", &Limits::max_ttl, "How long a session may ask to live without use", 1},
    {"max_stream_idle", &Limits::max_stream_idle, "How long a stream may say nothing", 1},
    {"idle_evict", &Limits::idle_evict,
     "When the memory of what nobody uses is given back; it is computed again when needed", 1, 1e9,
     false},
};

// Calls `visit` with the member that a row is about: a (const) std::size_t&, std::uint32_t&,
// double& or std::chrono::milliseconds&.
template <class AnyLimits, class Visit>
decltype(auto) VisitLimit(AnyLimits& limits, const LimitInfo& info, Visit&& visit) {
  return std::visit(
      [&](auto member) -> decltype(auto) {
        if constexpr (std::is_same_v<decltype(member), std::size_t OwnerLimits::*>) {
          return visit(limits.owner.*member);
        } else {
          return visit(limits.*member);
        }
      },
      info.member);
}

inline bool IsTime(const LimitInfo& info) {
  return std::holds_alternative<std::chrono::milliseconds Limits::*>(info.member);
}

// The name where a number stands alone: "max_ttl_seconds", "max_sessions".
inline std::string PlainName(const LimitInfo& info) {
  return std::string(info.name) + (IsTime(info) ? "_seconds" : "");
}

// The flag of arapd, without dashes in front: "max-sessions", "max-ttl-seconds". The name in the
// config file is the same; in the environment it is ARAPD_MAX_SESSIONS.
inline std::string FlagName(const LimitInfo& info) {
  std::string name = info.flag.empty() ? PlainName(info) : std::string(info.flag);
  for (char& c : name) c = c == '_' ? '-' : c;
  return name;
}

// The name in a token's own limits: "max_sessions" for max_sessions_per_owner. Empty for a limit
// that a token cannot state.
inline std::string_view TokenName(const LimitInfo& info) {
  constexpr std::string_view kSuffix = "_per_owner";
  if (!std::holds_alternative<std::size_t OwnerLimits::*>(info.member)) return {};
  return info.name.substr(0, info.name.size() - kSuffix.size());
}

}  // namespace arap
