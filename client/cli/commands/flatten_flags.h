// The command line of flatten.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/base/result.h"
#include "arap/client/flatten.h"
#include "arap/model/drawing.h"
#include "client/cli/commands/commands.h"
#include "client/cli/commands/own_words.h"
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

// What is drawn and how.
struct DrawingFlags {
  std::string svg, dxf, pdf;  // files to write; empty: not wanted
  // But for the format. DXF has no pages and does not show the edges inside.
  DrawingOptions options;
};

struct FlattenFlags {
  ServerFlags server;
  std::string surface;
  // Files to write; empty: not wanted. At least one is, or one of `drawing`.
  std::string out, report, compare;
  DrawingFlags drawing;
  // Files to read; empty: none.
  std::string seams, pins, rigidity;
  std::vector<std::string> grain;
  enum class Vt { kTrue, kUnit };
  Vt vt = Vt::kTrue;   // how large the layout in `out` is
  bool sigma = false;  // every triangle in the report
  bool json = false;   // the report on standard output
  Timeout timeout;
  std::string job;  // SESSION/JOB; empty: a call
  MethodFlags method;
  client::FlattenQuery query;  // but for what `method` and the files say
};

void AddFlattenFlags(CLI::App& command, FlattenFlags& flags);

// What stands in the files to read; empty where there is none.
struct FlattenTexts {
  std::string seams, pins, rigidity;
};

// kNotFound with the flag.
Result<FlattenTexts> ReadTexts(const FlattenFlags& flags);
// The query with what the method, the files and the grain lines say about a surface of so many
// vertices and triangles.
Result<client::FlattenQuery> ReadQuery(const FlattenFlags& flags, const FlattenTexts& texts,
                                       std::size_t vertex_count, std::size_t triangle_count);

// Where a request to flatten comes from: its files with their lines, and its flags. `mesh` is how the
// file of the surface counts. Refers to the flags and the texts.
std::vector<Origin> OriginsOf(const FlattenFlags& flags, const FlattenTexts& texts,
                              const Counting& mesh);

}  // namespace arap::cli
