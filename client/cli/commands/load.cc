// arapctl load: many streams at once.
#include <latch>
#include <memory>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"
#include "client/cli/load/load_stream.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/text_file.h"

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
  std::string json;
};

struct LoadResult {
  LoadSamples samples;  // of all streams
  double seconds = 0;   // from the common start to the last answer
  std::size_t vertices = 0;
};

void Merge(LoadSamples&& from, LoadSamples& to) {
  const auto append = [](const std::vector<double>& more, std::vector<double>& all) {
    all.insert(all.end(), more.begin(), more.end());
  };
  append(from.round_trip_micros, to.round_trip_micros);
  append(from.queue_micros, to.queue_micros);
  append(from.solve_micros, to.solve_micros);
  append(from.refused_micros, to.refused_micros);
  for (const auto& [reason, count] : from.errors) to.errors[reason] += count;
  if (to.first_error.empty()) to.first_error = std::move(from.first_error);
}

Result<LoadResult> Load(const LoadOptions& options) {
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
  LoadResult result;
  result.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  result.vertices = plan.mesh.vertices.size();
  for (LoadSamples& stream : samples) Merge(std::move(stream), result.samples);
  return result;
}

Status Report(const LoadOptions& options, const LoadResult& result) {
  const LoadSamples& samples = result.samples;
  const Percentiles round_trip = PercentilesOf(samples.round_trip_micros);
  const Percentiles queue = PercentilesOf(samples.queue_micros);
  const Percentiles solve = PercentilesOf(samples.solve_micros);
  const Percentiles refused = PercentilesOf(samples.refused_micros);
  const std::size_t updates = samples.round_trip_micros.size();
  const double rate = static_cast<double>(updates) / result.seconds;
  fmt::print("streams      {}\nconnections  {}\nvertices     {}\nhandles      {}\n",
             options.streams, options.connections, result.vertices, options.handles);
  fmt::print("seconds      {:.2f}\nupdates      {}\nupdates/s    {:.1f}\n", result.seconds, updates,
             rate);
  fmt::print("round trip   p50 {:.0f} µs, p90 {:.0f} µs, p99 {:.0f} µs, max {:.0f} µs\n",
             round_trip.p50, round_trip.p90, round_trip.p99, round_trip.max);
  fmt::print(
      "queue        p50 {:.0f} µs, p99 {:.0f} µs\nsolve        p50 {:.0f} µs, p99 {:.0f} µs\n",
      queue.p50, queue.p99, solve.p50, solve.p99);
  if (!samples.refused_micros.empty()) {
    fmt::print("no room      {} streams, told after p50 {:.0f} µs, max {:.0f} µs\n",
               samples.refused_micros.size(), refused.p50, refused.max);
  }
  for (const auto& [reason, count] : samples.errors)
    fmt::print("error        {} × {}\n", reason, count);
  if (samples.errors.empty()) fmt::print("errors       none\n");
  if (options.json.empty()) return {};
  const nlohmann::ordered_json json{{"streams", options.streams},
                                    {"connections", options.connections},
                                    {"vertices", result.vertices},
                                    {"handles", options.handles},
                                    {"seconds", result.seconds},
                                    {"updates", updates},
                                    {"updates_per_second", rate},
                                    {"round_trip_micros", ToJson(round_trip)},
                                    {"queue_micros", ToJson(queue)},
                                    {"solve_micros", ToJson(solve)},
                                    {"streams_refused", samples.refused_micros.size()},
                                    {"refused_micros", ToJson(refused)},
                                    {"errors", samples.errors}};
  return WriteTextFile(options.json, JsonText(json));
}

int RunLoad(const LoadOptions& options) {
  const Result<LoadResult> result = Load(options);
  if (!result) return Complain(result.error());
  if (const Status reported = Report(options, *result); !reported)
    return Complain(reported.error());
  if (result->samples.errors.empty() && !result->samples.round_trip_micros.empty()) return kOk;
  fmt::print(stderr, "arapctl: first error: {}\n",
             result->samples.first_error.empty() ? "no update was answered in time"
                                                 : result->samples.first_error);
  return kFailed;
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
  AddOutput(*command, "--json", options->json, "write the result", "FILE.json");
  command->callback([options, &run] { run = [options] { return RunLoad(*options); }; });
}

}  // namespace arap::cli
