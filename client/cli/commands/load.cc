// arapctl load: many streams at once.
#include <algorithm>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"
#include "client/cli/load/load_stream.h"
#include "client/cli/load/outputs.h"
#include "client/cli/report.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct LoadOptions {
  ServerFlags server;
  std::size_t streams = 8;
  std::size_t connections = 1;
  double seconds = 10;
  std::size_t vertices = 1000;
  std::size_t handles = 8;
  std::size_t refine = 0;
  double fps = 0;
  LoadOutputs outputs;
};

// What the streams have seen, as drags whose times were measured from when they should have been sent.
void Add(const LoadSamples& samples, LoadResults& results) {
  OperationResults& drag = results.operations[Operation::kDrag];
  for (const double micros : samples.round_trip_micros) drag.response.Record(micros);
  for (const double micros : samples.queue_micros) drag.queue.Record(micros);
  for (const double micros : samples.solve_micros) drag.solve.Record(micros);
  for (const double micros : samples.refused_micros) results.refused.Record(micros);
  drag.answered = drag.response.Count();
  for (const auto& [reason, count] : samples.errors) {
    const auto known = std::find_if(results.errors.begin(), results.errors.end(),
                                    [&](const LoadError& error) { return error.reason == reason; });
    LoadError& error = known == results.errors.end() ? results.errors.emplace_back() : *known;
    error.reason = reason;
    error.count += count;
    const std::string front = reason + ": ";
    if (error.first.empty() && samples.first_error.starts_with(front)) {
      error.first = samples.first_error.substr(front.size());
    }
    drag.failed += count;
  }
  drag.sent = drag.answered + drag.failed;
}

Result<LoadResults> Load(const LoadOptions& options) {
  TRY(const Connection connection, Connection::Open(options.server));
  std::vector<client::Client> clients{connection.client()};
  while (clients.size() < options.connections) {
    TRY(client::Client client, connection.Another());
    clients.push_back(std::move(client));
  }
  LoadPlan plan = MakeLoadPlan(options.vertices, options.handles,
                               std::chrono::duration<double>(options.seconds));
  plan.fps = options.fps;
  plan.deform.refine = static_cast<int>(options.refine);
  std::vector<LoadSamples> samples(options.streams);
  std::latch start(static_cast<std::ptrdiff_t>(options.streams) + 1);
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < options.streams; ++i) {
    threads.emplace_back(
        [&, i] { samples[i] = RunLoadStream(clients[i % clients.size()], plan, i, start); });
  }
  start.arrive_and_wait();
  const Clock::time_point began = Clock::now();
  threads.clear();  // joins them
  LoadResults results;
  results.how = options.fps > 0 ? fmt::format("{:g} updates a second of each stream", options.fps)
                                : std::string("closed loop, an update of each stream on its way");
  results.settings = {{"--streams", options.streams},   {"--connections", options.connections},
                      {"--vertices", options.vertices}, {"--handles", options.handles},
                      {"--refine", options.refine},     {"--seconds", options.seconds}};
  if (options.fps > 0) results.settings["--fps"] = options.fps;
  results.sessions = results.streams = options.streams;
  results.connections = options.connections;
  results.vertices = plan.mesh.vertices.size();
  results.handles = options.handles;
  results.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  for (const LoadSamples& stream : samples) Add(stream, results);
  return results;
}

int RunLoad(const LoadOptions& options) {
  const Result<LoadResults> results = Load(options);
  return results ? TellLoad(*results, options.outputs) : Complain(results.error());
}

}  // namespace

void AddLoad(CLI::App& app, Run& run) {
  auto options = std::make_shared<LoadOptions>();
  CLI::App* const command = app.add_subcommand(
      "load", "Put a server under load: streams with one update on its way each");
  AddServerFlags(*command, options->server);
  const auto add = [&](const char* flag, std::size_t& value, double least, double most,
                       const std::string& help) {
    command->add_option(flag, value, fmt::format("{}; default {}", help, value))
        ->check(CLI::Range(least, most).description(""))
        ->option_text("N");
  };
  add("--streams", options->streams, 1, 10'000, "streams, each with a session of its own");
  add("--connections", options->connections, 1, 1000, "connections that the streams share");
  add("--vertices", options->vertices, 4, 1e7, "about so many vertices of the mesh");
  add("--handles", options->handles, 1, 1000, "handles on it");
  add("--refine", options->refine, 0, 1000, "further iterations of every update");
  command->add_option("--seconds", options->seconds, "how long to send; default 10")
      ->check(CLI::Range(0.01, 1e6).description(""))
      ->option_text("S");
  command
      ->add_option(
          "--fps", options->fps,
          "updates a second of each stream, as a hand makes them, and streams begin as they "
          "are opened; default as fast as they are answered")
      ->check(CLI::Range(0.01, 1e5).description(""))
      ->option_text("R");
  AddLoadOutputs(*command, options->outputs);
  AddLoadCompare(*command, run);
  command->require_subcommand(0, 1);
  command->callback([command, options, &run] {
    if (!command->got_subcommand("compare")) run = [options] { return RunLoad(*options); };
  });
}

}  // namespace arap::cli
