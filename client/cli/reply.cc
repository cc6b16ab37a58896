#include "client/cli/reply.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "client/cli/exit_code.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

OrderedJson ErrorOf(Exit exit) {
  return {{"exit_code", static_cast<int>(exit)}, {"class", InfoOf(exit).name}};
}

}  // namespace

OrderedJson WarningsJson(const std::vector<Warning>& warnings) {
  OrderedJson list = OrderedJson::array();
  for (const Warning& warning : warnings) {
    list.push_back({{"kind", warning.kind},
                    {"count", warning.count},
                    {"elements", warning.elements},
                    {"message", warning.message}});
  }
  return list;
}

OrderedJson ErrorJson(const Fault& fault) {
  OrderedJson error = ErrorOf(ExitOf(fault.kind));
  error["reason"] = ReasonOf(fault);
  error["message"] = fault.message;
  if (!fault.elements.empty()) error["elements"] = fault.elements;
  if (!fault.field.empty()) error["field"] = fault.field;
  for (const auto& [name, value] : fault.details) error["details"][name] = value;
  return {{"error", std::move(error)}};
}

OrderedJson UsageErrorJson(const std::string& message) {
  OrderedJson error = ErrorOf(Exit::kUsage);
  error["message"] = message;
  return {{"error", std::move(error)}};
}

void AddJson(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "answer in JSON, errors too (docs/arapctl.md)")
      ->check(CLI::Validator(
          [](std::string&) {
            return TakeStandardOutput("--json") ? std::string()
                                                : "standard output is for another option already";
          },
          ""));
}

int Finish(const Result<Reply>& reply, bool json) {
  const int code = reply ? kOk : Complain(reply.error());
  if (json) {
    OrderedJson document = reply ? reply->json : ErrorJson(reply.error());
    if (!PrintedWarnings().empty() && !document.contains("warnings")) {
      document["warnings"] = WarningsJson(PrintedWarnings());
    }
    fmt::print("{}", JsonText(document));
  } else if (reply) {
    Say(reply->text);
  }
  return code;
}

std::string FormatTime(std::chrono::system_clock::time_point time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  std::tm parts{};
  return gmtime_r(&seconds, &parts) == nullptr ? "?" : fmt::format("{:%FT%TZ}", parts);
}

std::string Table(const std::vector<std::vector<std::string>>& rows) {
  std::string text;
  if (rows.size() < 2) return text;
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], CharactersIn(row[i]));
    }
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      line.append(widths[i] - CharactersIn(row[i]) + 2, ' ');
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace arap::cli
