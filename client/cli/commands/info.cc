// arapctl info: what the server is and what it allows.
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

struct InfoOptions {
  ServerFlags server;
  bool json = false;
};

double Seconds(std::chrono::nanoseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

nlohmann::ordered_json LimitsJson(const client::Limits& limits) {
  return {{"max_vertices", limits.max_vertices},
          {"max_triangles", limits.max_triangles},
          {"max_handles", limits.max_handles},
          {"max_sessions", limits.max_sessions},
          {"max_meshes_per_session", limits.max_meshes_per_session},
          {"max_handle_sets_per_session", limits.max_handle_sets_per_session},
          {"max_message_bytes", limits.max_message_bytes},
          {"max_refine", limits.max_refine},
          {"max_ttl_seconds", Seconds(limits.max_ttl)},
          {"max_streams", limits.max_streams},
          {"max_track_frames", limits.max_track_frames},
          {"max_flatten_triangles", limits.max_flatten_triangles},
          {"max_cached_surfaces", limits.max_cached_surfaces},
          {"max_cached_surface_bytes", limits.max_cached_surface_bytes},
          {"max_sessions_per_owner", limits.max_sessions_per_owner},
          {"max_meshes_per_owner", limits.max_meshes_per_owner},
          {"max_handle_sets_per_owner", limits.max_handle_sets_per_owner},
          {"max_bytes_per_owner", limits.max_bytes_per_owner},
          {"max_streams_per_owner", limits.max_streams_per_owner},
          {"max_bytes", limits.max_bytes},
          {"max_registrations", limits.max_registrations},
          {"max_compilations", limits.max_compilations},
          {"max_flattenings", limits.max_flattenings},
          {"max_queued_jobs", limits.max_queued_jobs},
          {"max_stream_fps", limits.max_stream_fps},
          {"max_stream_idle_seconds", Seconds(limits.max_stream_idle)},
          {"max_stream_load", limits.max_stream_load}};
}

int RunInfo(const InfoOptions& options) {
  const Result<Connection> connection = Connection::Open(options.server);
  if (!connection) return Complain(connection.error());
  const Result<client::ServerInfo> info = connection->client().GetServerInfo();
  if (!info) return Complain(info.error());
  const nlohmann::ordered_json limits = LimitsJson(info->limits);
  if (options.json) {
    const nlohmann::ordered_json json{{"version", info->version},
                                      {"workers", info->workers},
                                      {"limits", limits},
                                      {"capabilities", info->capabilities}};
    fmt::print("{}\n", json.dump(2));
    return kOk;
  }
  fmt::print("version       {}\nworkers       {}\n", info->version, info->workers);
  fmt::print("capabilities  {}\n", fmt::join(info->capabilities, " "));
  for (const auto& [name, value] : limits.items()) fmt::print("{:<28} {}\n", name, value.dump());
  return kOk;
}

}  // namespace

void AddInfo(CLI::App& app, Run& run) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* const command = app.add_subcommand("info", "Version, limits and capabilities");
  AddServerFlags(*command, options->server);
  command->add_flag("--json", options->json, "answer in JSON");
  command->callback([options, &run] { run = [options] { return RunInfo(*options); }; });
}

}  // namespace arap::cli
