// arapctl info: what the server is and what it allows.
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"
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

Result<Reply> Info(const InfoOptions& options) {
  TRY(const Connection connection, Connection::Open(options.server));
  TRY(const client::ServerInfo info, connection.client().GetServerInfo({std::chrono::seconds(30)}));
  const nlohmann::ordered_json limits = LimitsJson(info.limits);
  Reply answer{
      {{"version", info.version},
       {"workers", info.workers},
       {"limits", limits},
       {"capabilities", info.capabilities}},
      fmt::format("version       {}\nworkers       {}\n", Printable(info.version), info.workers)};
  constexpr std::string_view kLabel = "capabilities  ";
  const std::string words = Wrapped(Printable(fmt::format("{}", fmt::join(info.capabilities, " "))),
                                    kLineWidth, kLabel.size());
  answer.text += std::string(kLabel) + (words.empty() ? "none\n" : words.substr(kLabel.size()));
  for (const auto& [name, value] : limits.items()) {
    answer.text += fmt::format("{:<28} {}\n", name, value.dump());
  }
  return answer;
}

}  // namespace

void AddInfo(CLI::App& app, Run& run) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* const command = app.add_subcommand("info", "Version, limits and capabilities");
  AddServerFlags(*command, options->server);
  SetReply(*command, run, options, &Info);
}

}  // namespace arap::cli
