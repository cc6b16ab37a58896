// The command line of flatten.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/base/result.h"
#include "arap/client/flatten.h"
#include "client/cli/commands/commands.h"
#include "client/cli/connect/connection.h"

namespace arap::cli {

// Which layout. What is empty is as the preset of the method has it.
struct MethodFlags {
  enum class Method { kArap, kArapEdge, kArapFace, kLscm, kFirstStep, kAbf };

  Method method = Method::kArap;
  std::optional<Basis> basis;
  std::optional<Weights> weights;
  std::optional<FlattenAnchors> anchors;
  std::optional<std::uint32_t> refine;
  std::optional<double> refine_stop;
  bool injective = false;

  // kInvalidOption when basis or weights do not go with the method.
  Result<FlattenOptions> Options() const;
};

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
  Timeout timeout;
  std::string job;  // SESSION/JOB; empty: a call
  MethodFlags method;
  client::FlattenQuery query;  // but for what `method` and the files say
};

void AddFlattenFlags(CLI::App& command, FlattenFlags& flags);

// The query with what the method, the files and the grain lines say about a surface of so many
// vertices and triangles.
Result<client::FlattenQuery> ReadQuery(const FlattenFlags& flags, std::size_t vertex_count,
                                       std::size_t triangle_count);

}  // namespace arap::cli
