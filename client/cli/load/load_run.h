// A run of the load generator, from what was asked for to what was found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "arap/client/client.h"
#include "client/cli/connect/connection.h"
#include "client/cli/load/chance.h"
#include "client/cli/load/rates.h"
#include "client/cli/load/results.h"
#include "client/cli/load/scene.h"
#include "client/cli/load/threshold.h"

namespace arap::cli {

// arapd takes 320 calls on a connection; further ones wait, and nobody says so.
inline constexpr std::size_t kStreamsOfAConnection = 250;

struct LoadRequest {
  ServerFlags server;
  std::vector<std::string> more_token_files;  // further tokens; sessions are dealt round

  std::size_t streams = 8;
  std::optional<std::size_t> sessions;     // default: one for each stream
  std::optional<std::size_t> connections;  // default: one for each kStreamsOfAConnection streams

  std::size_t vertices = 1000, handles = 8;
  std::string mesh_file, handles_file;  // instead of the numbers
  DeformOptions deform;
  client::PositionEncoding encoding = client::PositionEncoding::kFloat32;
  client::Delivery delivery = client::Delivery::kEvery;
  Mix mix;
  std::uint64_t seed = 0;

  // That count; of a search for each rate. Default: 10, and as long as it takes with `count`.
  std::optional<double> seconds;
  double warm_up = 0;                  // before them; of a search and a profile before each rate
  std::optional<std::uint64_t> count;  // messages in all
  std::optional<double> until_stable;  // percent (StabilityRule); seconds are then the most

  // At most one of the four; none: a closed loop. With `search`, `rate` is the first one to be tried.
  std::optional<double> fps;          // of each stream from its opening on, one on its way
  std::optional<double> rate;         // of all streams together
  std::optional<double> stream_rate;  // of each stream
  std::optional<std::string> profile;
  std::optional<Threshold> search;
  double resolution = 0.05;  // of the search
  bool poisson = false;
  std::optional<std::size_t> window;  // default: 1, and no bound in an open loop without `fps`

  double echo = 0;  // pings a second, all streams together
  double transport =
      0;              // seconds of echoes of the same sizes, before everything else (EchoService)
  double verify = 0;  // which part of the answers
  std::optional<double>
      resume;          // seconds; default 10, and 0 with a private server, which does not come back
  bool quiet = false;  // no line of how it goes
};

// Reads, connects, opens, sends, waits, closes. `how` of the results and all numbers are filled in;
// `settings` are the caller's. What streams and messages ran into is in the results; faults are of
// reading, connecting and of a wrong request alone. When `stop` is asked to, results are those so far.
Result<LoadResults> RunLoad(const LoadRequest& request, std::stop_token stop);

}  // namespace arap::cli
