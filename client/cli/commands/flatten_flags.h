// The command line of flatten.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/base/result.h"
#include "arap/client/flatten.h"
#include "client/cli/connect/connection.h"

namespace arap::cli {

struct FlattenFlags {
  ServerFlags server;
  std::string surface;
  // Files to write; empty: not wanted. At least one is.
  std::string out, svg, dxf, report, compare;
  // Files to read; empty: none.
  std::string seams, pins, rigidity;
  std::vector<std::string> grain;
  double millimetres_per_unit = 1;
  double allowance = 0;
  bool sigma = false;  // every triangle in the report
  bool interior = false;
  bool plain = false;
  std::optional<double> timeout_seconds;
  client::FlattenOptions options;

  std::optional<std::chrono::milliseconds> timeout() const;
};

void AddFlattenFlags(CLI::App& command, FlattenFlags& flags);

// The options with what the files and grain lines say about a surface of so many vertices and
// triangles.
Result<client::FlattenOptions> ReadOptions(const FlattenFlags& flags, std::size_t vertex_count,
                                           std::size_t triangle_count);

}  // namespace arap::cli
