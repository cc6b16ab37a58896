// arapctl session: the sessions of a server.
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "client/cli/commands/commands.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

struct SessionFlags : NamedOptions {
  double ttl = 0;  // seconds; 0: the server's choice
  std::vector<std::string> labels;
};

double SecondsOf(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

OrderedJson ToJson(const client::SessionInfo& info) {
  return {{"id", info.id},
          {"created", FormatTime(info.create_time)},
          {"expires", FormatTime(info.expire_time)},
          {"ttl_seconds", SecondsOf(info.ttl)},
          {"labels", info.labels},
          {"meshes", info.mesh_ids},
          {"handle_sets", info.handle_set_ids}};
}

std::string LabelsText(const std::map<std::string, std::string>& labels) {
  std::vector<std::string> words;
  for (const auto& [key, value] : labels) words.push_back(Printable(key + "=" + value));
  return words.empty() ? "-" : fmt::format("{}", fmt::join(words, " "));
}

std::string Names(const std::vector<std::string>& names) {
  return names.empty() ? "-" : Printable(fmt::format("{}", fmt::join(names, " ")));
}

std::string SessionText(const client::SessionInfo& info) {
  return fmt::format(
      "session  {}\ncreated  {}\nexpires  {} (after {:g} s without use)\nlabels   {}\nmeshes   {}\n"
      "handles  {}\n",
      Printable(info.id), FormatTime(info.create_time), FormatTime(info.expire_time),
      SecondsOf(info.ttl), LabelsText(info.labels), Names(info.mesh_ids),
      Names(info.handle_set_ids));
}

Result<Reply> CreateSession(const SessionFlags& flags) {
  client::SessionOptions options;
  options.id = flags.name;
  if (flags.ttl > 0) options.ttl = std::chrono::milliseconds(std::llround(flags.ttl * 1000));
  for (const std::string& label : flags.labels) {
    const std::size_t equals = label.find('=');
    options.labels[label.substr(0, equals)] = label.substr(equals + 1);
  }
  TRY(const Connection connection, Connection::Open(flags.server));
  TRY(const client::Session session, connection.client().CreateSession(options, flags.call()));
  TRY(const client::SessionInfo info, session.Get(flags.call()));
  return Reply{ToJson(info), SessionText(info)};
}

Result<Reply> ListSessions(const SessionFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  OrderedJson list = OrderedJson::array();
  std::vector<std::vector<std::string>> rows{{"SESSION", "EXPIRES", "MESHES", "HANDLES", "LABELS"}};
  std::string token;
  do {
    TRY(client::SessionPage page, connection.client().ListSessions(0, token, flags.call()));
    for (const client::SessionInfo& info : page.sessions) {
      list.push_back(ToJson(info));
      rows.push_back({Printable(info.id), FormatTime(info.expire_time),
                      std::to_string(info.mesh_ids.size()),
                      std::to_string(info.handle_set_ids.size()), LabelsText(info.labels)});
    }
    // A server that gives the same page again would be listed for ever.
    if (!page.next_page_token.empty() && page.next_page_token == token) {
      return Fail(FaultKind::kInternal, "The server lists the same sessions again.");
    }
    token = std::move(page.next_page_token);
  } while (!token.empty());
  return Reply{{{"sessions", std::move(list)}}, Table(rows)};
}

Result<Reply> ShowSession(const SessionFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  TRY(const client::SessionInfo info,
      connection.client().AttachSession(flags.name).Get(flags.call()));
  return Reply{ToJson(info), SessionText(info)};
}

Result<Reply> DeleteSession(const SessionFlags& flags) {
  TRY(const Connection connection, Connection::Open(flags.server));
  CHECK_OK(connection.client().AttachSession(flags.name).Delete(flags.call()));
  return Reply{{{"deleted", flags.name}}, fmt::format("deleted {}\n", flags.name)};
}

}  // namespace

void AddSession(CLI::App& app, Run& run) {
  CLI::App* const session =
      app.add_subcommand("session", "Sessions on a server: what has meshes and handles");
  session->require_subcommand(1);
  const auto add = [&](const char* name, const char* help, const char* shape,
                       Result<Reply> (*action)(const SessionFlags&)) {
    auto flags = std::make_shared<SessionFlags>();
    CLI::App* const command = session->add_subcommand(name, help);
    AddNamed(*command, *flags, shape, "the id of the session");
    SetReply(*command, run, flags, action);
    return std::pair(command, flags);
  };
  const auto [create, flags] =
      add("create", "Open a session that others may use by its id", "SESSION", &CreateSession);
  create->add_option("--ttl", flags->ttl, "how long it lives without use; default an hour")
      ->check(Between(1, 1e9))
      ->option_text("SECONDS");
  create->add_option("--label", flags->labels, "a label; may be given again")
      ->allow_extra_args(false)
      ->check(CLI::Validator(
          [](std::string& text) {
            const std::size_t equals = text.find('=');
            return equals == std::string::npos || equals == 0 ? text + " is not KEY=VALUE"
                                                              : std::string();
          },
          ""))
      ->option_text("KEY=VALUE");
  add("list", "Your sessions, a line for each", "", &ListSessions);
  add("show", "What a session has and when it expires; does not extend its life", "SESSION",
      &ShowSession);
  add("delete", "End a session with all that it has; its streams end", "SESSION", &DeleteSession);
}

}  // namespace arap::cli
