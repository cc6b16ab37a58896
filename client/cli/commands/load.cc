// arapctl load: a server under load.
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/load/load_run.h"
#include "client/cli/load/outputs.h"
#include "client/cli/load/schedule.h"
#include "client/cli/patience.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

struct LoadOptions {
  LoadRequest request;
  LoadOutputs outputs;
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();
};

int RunLoadCommand(const LoadOptions& options) {
  std::stop_source stop;
  std::optional<Result<LoadResults>> results;
  {
    // Waits are limited where they are made; here it is for Ctrl-C.
    const Patience patience(std::chrono::hours(24 * 365), [&] { stop.request_stop(); });
    results = RunLoad(options.request, stop.get_token());
  }
  if (!*results) return Complain(results->error());
  (*results)->settings = options.settings;
  const int code = TellLoad(**results, options.outputs);
  return stop.stop_requested() ? static_cast<int>(Exit::kInterrupted) : code;
}

std::map<std::string, client::PositionEncoding> Encodings() {
  return {{"float32", client::PositionEncoding::kFloat32},
          {"float32-le", client::PositionEncoding::kFloat32Le},
          {"int16-le", client::PositionEncoding::kInt16Le}};
}
std::map<std::string, client::Delivery> Deliveries() {
  return {{"every", client::Delivery::kEvery}, {"latest", client::Delivery::kLatest}};
}
std::map<std::string, bool> Arrivals() { return {{"constant", false}, {"poisson", true}}; }

template <class Value>
std::string NameIn(const std::map<std::string, Value>& names, Value value) {
  const auto named = std::find_if(names.begin(), names.end(),
                                  [&](const auto& name) { return name.second == value; });
  return named == names.end() ? std::string() : named->first;
}

// What was said on the command line, in the environment or in the config file. CLI11 has put numbers
// in the place of names.
nlohmann::ordered_json SettingsOf(const CLI::App& command, const LoadRequest& request) {
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();
  for (const CLI::Option* const option :
       command.get_options([](const CLI::Option* one) { return one->count() > 0; })) {
    if (option->get_lnames().empty()) continue;
    settings["--" + option->get_lnames().front()] =
        fmt::format("{}", fmt::join(option->results(), " "));
  }
  const auto name = [&](const char* flag, const std::string& value) {
    if (settings.contains(flag)) settings[flag] = value;
  };
  name("--encoding", NameIn(Encodings(), request.encoding));
  name("--delivery", NameIn(Deliveries(), request.delivery));
  name("--arrivals", NameIn(Arrivals(), request.poisson));
  return settings;
}

// A validator that hands the text to a parser and keeps what it has made of it.
template <class Value, class Parse>
CLI::Option* AddParsed(CLI::App& command, const char* flag, Value& value, Parse parse,
                       const char* text, const std::string& help) {
  return command
      .add_option_function<std::string>(
          flag, [&value, parse](const std::string& said) { value = *parse(said); }, help)
      ->check(CLI::Validator(
          [parse](std::string& said) {
            const auto parsed = parse(said);
            return parsed ? std::string() : parsed.error().message;
          },
          ""))
      ->option_text(text);
}

// "8" is a number of handles, anything else a file.
bool IsNumber(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

void AddScene(CLI::App& command, LoadRequest& request) {
  command
      .add_option("--vertices", request.vertices,
                  "about so many vertices of the mesh, a grid; default 1000")
      ->check(Between(4, 1e7))
      ->option_text("N");
  command.add_option("--mesh", request.mesh_file, "the mesh of a file instead, in any plane")
      ->excludes("--vertices")
      ->option_text("FILE");
  command
      .add_option_function<std::string>(
          "--handles",
          [&request](const std::string& said) {
            if (IsNumber(said)) {
              request.handles = std::stoul(said);
            } else {
              request.handles_file = said;
            }
          },
          "so many handles on it, or those of a track; default 8")
      ->check(CLI::Validator(
          [](std::string& said) {
            if (!IsNumber(said) || (said.size() <= 4 && std::stoul(said) - 1 < 1000)) {
              return std::string();
            }
            return said + " is not a number from 1 to 1000";
          },
          ""))
      ->option_text("N|TRACK.json");
  command
      .add_option("--refine", request.deform.refine,
                  "further iterations of every update; default 0")
      ->check(Between(0, 1000))
      ->option_text("N");
  AddMeasureEvery(command, request.deform);
  AddChoice(command, "--encoding", request.encoding, Encodings(),
            "how positions travel; default float32");
}

// One of --fps, --rate, --stream-rate and --profile; --search goes with --rate alone.
void AddRates(CLI::App& command, LoadRequest& request) {
  const auto rate = [&](const char* flag, std::optional<double>& value, const std::string& help) {
    return command.add_option(flag, value, help)->check(Between(0.01, 1e6))->option_text("R");
  };
  auto* const fps =
      rate("--fps", request.fps,
           "updates a second of each stream, as a hand makes them: one on its way, and "
           "streams begin as they are opened");
  auto* const total = rate("--rate", request.rate,
                           "messages a second of all streams together, whatever the server does");
  auto* const each = rate("--stream-rate", request.stream_rate, "the same of each stream");
  auto* const profile = AddParsed(
      command, "--profile", request.profile,
      [](const std::string& text) {
        return RateProfile::Parse(text, 1).map([&](const RateProfile&) { return text; });
      },
      "PROFILE",
      "step:RATE,RATE,… or ramp:FROM,TO: rates of all streams together, one after the other within "
      "--seconds");
  auto* const search = AddParsed(
      command, "--search", request.search,
      [](const std::string& text) { return ParseThreshold(text); }, "RULE",
      "find the highest rate at which the rule holds, such as \"p99<20ms\", 98 % of what is due is "
      "answered and nothing fails. Each rate takes --seconds; --rate is the first one, default "
      "100");
  const std::vector<CLI::Option*> ways{fps, each, profile, total};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    for (std::size_t k = i + 1; k < ways.size(); ++k) ways[i]->excludes(ways[k]);
    if (ways[i] != total) ways[i]->excludes(search);
  }
  command
      .add_option_function<double>(
          "--resolution", [&request](double percent) { request.resolution = percent / 100; },
          "how exact the search is, in percent of the rate; default 5")
      ->needs(search)
      ->check(Between(0.1, 100))
      ->option_text("PERCENT");
  AddChoice(command, "--arrivals", request.poisson, Arrivals(),
            "whether the messages of an open loop are evenly spaced or come as those of many "
            "people do; default constant");
  command
      .add_option("--window", request.window,
                  "so many messages of a stream may be without answer; default 1, and with --rate, "
                  "--stream-rate, --profile and --search as many as it takes")
      ->check(Between(1, kMostOnTheirWay))
      ->option_text("N");
}

void AddLength(CLI::App& command, LoadRequest& request) {
  command.add_option("--seconds", request.seconds, "how long to send; default 10")
      ->check(Between(0.01, 1e6))
      ->option_text("S");
  command
      .add_option("--warm-up", request.warm_up,
                  "send for so long before, without counting it; of a search and a profile before "
                  "each rate")
      ->check(Between(0, 1e6))
      ->option_text("S");
  command
      .add_option("--count", request.count,
                  "so many messages in all, as long as it takes unless --seconds is given")
      ->excludes("--search")
      ->check(Between(1, 1e15))
      ->option_text("N");
  command
      .add_option(
          "--until-stable", request.until_stable,
          "end when rate and median of the last five seconds differ by no more from their means")
      ->excludes("--search")
      ->check(Between(0.1, 100))
      ->option_text("PERCENT");
}

void AddBusiness(CLI::App& command, LoadRequest& request) {
  AddParsed(
      command, "--mix", request.mix, [](const std::string& text) { return Mix::Parse(text); },
      "MIX",
      "what messages are, by weight: drag=90,edit=5,bake=2,flatten=2,register=1; default drag=1. "
      "Baking (10 frames), flattening and registering are calls beside the streams");
  AddChoice(command, "--delivery", request.delivery, Deliveries(),
            "whether the server answers every update or the latest; default every");
  command
      .add_option("--seed", request.seed, "another one means other times and targets; default 0")
      ->option_text("N");
  command
      .add_option("--echo", request.echo,
                  "pings a second in the same streams, for their round trip")
      ->check(Between(0, 1e6))
      ->option_text("R");
  command
      .add_option("--transport", request.transport,
                  "measure first, for so long, messages of the same sizes that nothing is computed "
                  "for: what the transport takes by itself. Wants arapd --echo, or --spawn")
      ->check(Between(0.1, 1e6))
      ->option_text("S");
  command
      .add_option(
          "--verify", request.verify,
          "compute this part of the answers again, with a private arapd, and compare; 0 to 1, "
          "default 0")
      ->check(Between(0, 1))
      ->option_text("PART");
  command
      .add_option(
          "--resume", request.resume,
          "for how long streams that were lost are opened again; 0: not at all; default 10, "
          "with --spawn 0")
      ->check(Between(0, 1e6))
      ->option_text("S");
  command
      .add_option("--also-token-file", request.more_token_files,
                  "file with a further token; may be given again. Sessions are dealt round")
      ->allow_extra_args(false)
      ->option_text("FILE");
  command.add_flag("--quiet", request.quiet, "do not show how it goes");
}

}  // namespace

void AddLoad(CLI::App& app, Run& run) {
  auto options = std::make_shared<LoadOptions>();
  LoadRequest& request = options->request;
  CLI::App* const command =
      app.add_subcommand("load", "Put a server under load, and measure how it bears it");
  AddServerFlags(*command, request.server);
  const auto add = [&](const char* flag, auto& value, double most, const std::string& help) {
    command->add_option(flag, value, help)->check(Between(1, most))->option_text("N");
  };
  add("--streams", request.streams, 100'000, "streams; default 8");
  add("--sessions", request.sessions, 100'000, "sessions that they share; default one for each");
  add("--connections", request.connections, 1000,
      fmt::format(
          "connections that they share; default one for each {} streams (arapd takes 320 calls "
          "on a connection)",
          kStreamsOfAConnection));
  AddScene(*command, request);
  AddRates(*command, request);
  AddLength(*command, request);
  AddBusiness(*command, request);
  AddLoadOutputs(*command, options->outputs);
  AddLoadCompare(*command, run);
  command->require_subcommand(0, 1);
  command->callback([options, command, &run] {
    if (command->got_subcommand("compare")) return;
    const LoadRequest& said = options->request;
    if (said.poisson && !said.fps && !said.rate && !said.stream_rate && !said.profile &&
        !said.search) {
      throw CLI::ValidationError("--arrivals",
                                 "a closed loop has none: give --rate, --stream-rate, --fps, "
                                 "--profile or --search");
    }
    options->settings = SettingsOf(*command, said);
    run = [options] { return RunLoadCommand(*options); };
  });
}

}  // namespace arap::cli
