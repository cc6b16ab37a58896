// arapctl watch: what a server does, again and again.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>
#include <unistd.h>

#include "client/cli/commands/commands.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"
#include "client/cli/watch/server_view.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

struct WatchOptions {
  std::string admin;
  double interval = 1;
  bool once = false;
  bool json = false;
};

// HOST and PORT of "HOST:PORT"; port 0 for anything else.
std::pair<std::string, int> SplitAddress(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  int port = 0;
  if (colon == std::string::npos || colon == 0) return {address, 0};
  const char* const end = address.data() + address.size();
  const auto [stop, error] = std::from_chars(address.data() + colon + 1, end, port);
  if (error != std::errc() || stop != end || port < 1 || port > 65'535) return {address, 0};
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  }
  return {std::move(host), port};
}

Result<Metrics> ReadMetrics(const std::string& address) {
  constexpr std::size_t kMost = 16'000'000;
  const auto [host, port] = SplitAddress(address);
  httplib::Client client(host, port);
  client.set_connection_timeout(5);
  client.set_read_timeout(5);
  std::string text;
  const auto answer = client.Get("/metrics", [&text](const char* data, std::size_t size) {
    text.append(data, size);
    return text.size() <= kMost;
  });
  if (!answer) {
    return Fail(
        FaultKind::kDraining,
        fmt::format("No admin page answers at {} ({}); arapd says at its start where it is.",
                    address, httplib::to_string(answer.error())));
  }
  if (answer->status != 200) {
    return Fail(FaultKind::kDraining,
                fmt::format("{} answers /metrics with status {}.", address, answer->status));
  }
  return ParseMetrics(text);
}

// Takes the place of what was shown before.
void Show(const std::string& screen, std::size_t& lines_shown) {
  std::string text = lines_shown > 0 ? fmt::format("\033[{}A\033[J", lines_shown) : "";
  lines_shown = static_cast<std::size_t>(std::count(screen.begin(), screen.end(), '\n'));
  text += screen;
  fmt::print("{}", text);
  std::fflush(stdout);
}

Result<Reply> WatchOnce(const WatchOptions& options) {
  TRY(const Metrics before, ReadMetrics(options.admin));
  std::this_thread::sleep_for(std::chrono::duration<double>(options.interval));
  TRY(const Metrics now, ReadMetrics(options.admin));
  const ServerView view = ViewOf(before, now, options.interval, std::chrono::system_clock::now());
  return Reply{ToJson(view), ScreenOf(view)};
}

// Until Ctrl-C. A server that does not answer is waited for once it has answered.
Status WatchOn(const WatchOptions& options) {
  using std::chrono::steady_clock;
  TRY(Metrics before, ReadMetrics(options.admin));
  steady_clock::time_point read = steady_clock::now();
  const bool in_place = IsTerminal(STDOUT_FILENO) && !options.json;
  std::size_t lines_shown = 0;
  for (;;) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options.interval));
    const steady_clock::time_point start = steady_clock::now();
    Result<Metrics> now = ReadMetrics(options.admin);
    if (!now) {
      if (in_place) {
        Show(Wrapped(Describe(now.error()), kLineWidth), lines_shown);
      } else {
        Complain(now.error());
      }
      continue;
    }
    const double seconds = std::chrono::duration<double>(start - read).count();
    const auto time = std::chrono::system_clock::now();
    const ServerView view = ViewOf(before, *now, std::max(seconds, 1e-3), time);
    before = std::move(*now);
    read = start;
    if (in_place) {
      Show(ScreenOf(view), lines_shown);
      continue;
    }
    if (options.json) {
      OrderedJson json{{"time", FormatTime(time)}};
      json.update(ToJson(view));
      fmt::print("{}\n", json.dump());
    } else {
      fmt::print("{} {}", FormatTime(time), LineOf(view));
    }
    if (std::fflush(stdout) != 0) return Fail(FaultKind::kInternal, "cannot write standard output");
  }
}

}  // namespace

void AddWatch(CLI::App& app, Run& run) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* const command = app.add_subcommand(
      "watch", "Show what a server does: rates, latencies, queues, memory, again and again");
  command
      ->add_option("ADMIN", options->admin,
                   "its admin page, HOST:PORT; arapd says at its start where it is")
      ->required()
      ->check(CLI::Validator(
          [](std::string& text) {
            return SplitAddress(text).second != 0 ? std::string() : text + " is not HOST:PORT";
          },
          ""));
  command->add_option("--interval", options->interval, "how long between two readings; default 1")
      ->check(Between(0.1, 3600))
      ->option_text("SECONDS");
  command->add_flag("--once", options->once, "show one interval and end");
  AddJson(*command, options->json);
  command->callback([options, &run] {
    run = [options] {
      if (options->once) return Finish(WatchOnce(*options), options->json);
      const Status ended = WatchOn(*options);
      return ended ? kOk : Finish(Fail(ended.error()), options->json);
    };
  });
}

}  // namespace arap::cli
