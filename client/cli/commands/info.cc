// arapctl info: what the server is and what it allows.
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"
#include "client/cli/report.h"
#include "core/base/try.h"

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

Status Info(const InfoOptions& options) {
  TRY(const Connection connection, Connection::Open(options.server));
  TRY(const client::ServerInfo info, connection.client().GetServerInfo({std::chrono::seconds(30)}));
  const nlohmann::ordered_json limits = LimitsJson(info.limits);
  if (options.json) {
    const nlohmann::ordered_json json{{"version", info.version},
                                      {"workers", info.workers},
                                      {"limits", limits},
                                      {"capabilities", info.capabilities}};
    fmt::print("{}", JsonText(json));
    return {};
  }
  fmt::print("version       {}\nworkers       {}\n", Printable(info.version), info.workers);
  fmt::print("capabilities  {}\n", Printable(fmt::format("{}", fmt::join(info.capabilities, " "))));
  for (const auto& [name, value] : limits.items()) fmt::print("{:<28} {}\n", name, value.dump());
  return {};
}

}  // namespace

void AddInfo(CLI::App& app, Run& run) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* const command = app.add_subcommand("info", "Version, limits and capabilities");
  AddServerFlags(*command, options->server);
  command->add_flag("--json", options->json, "answer in JSON");
  SetAction(*command, run, options, &Info);
}

}  // namespace arap::cli
