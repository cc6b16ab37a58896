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

nlohmann::ordered_json LimitsJson(const client::Limits& limits) {
  nlohmann::ordered_json json;
  for (const LimitInfo& info : kLimits) {
    if (!info.served) continue;
    VisitLimit(limits, info, [&]<class Value>(const Value& value) {
      if constexpr (std::is_same_v<Value, std::chrono::milliseconds>) {
        json[PlainName(info)] = std::chrono::duration<double>(value).count();
      } else {
        json[PlainName(info)] = value;
      }
    });
  }
  return json;
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
