// arapctl flatten: a surface laid flat, true to size.
#include <memory>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/flatten_flags.h"
#include "client/cli/commands/flatten_report.h"
#include "client/cli/commands/lay_flat.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/drawing/comparison.h"
#include "core/drawing/dxf.h"
#include "core/drawing/pattern.h"
#include "core/drawing/pattern_sheet.h"
#include "core/files/mesh_file.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

// Writes `text` unless no name is given.
Status WriteWanted(const std::string& path, const std::string& text) {
  return path.empty() ? Status() : WriteTextFile(path, text);
}

Status WriteLayout(const FlattenFlags& flags, const std::vector<GrainLine>& grain,
                   const SurfaceMesh& mesh, const client::FlatSurface& answer) {
  const Flattening& flat = answer.flat;
  const std::vector<std::string> summary = Summary(mesh, flat);
  for (const std::string& line : summary) fmt::print("{}\n", line);
  if (!flags.out.empty()) {
    CHECK_OK(WriteTextFile(flags.out, FormatObj(mesh, flat.uv, flat.corner_uv)));
  }
  if (!flags.svg.empty() || !flags.dxf.empty()) {
    TRY(const Pattern pattern,
        MakePattern(flat, {flags.millimetres_per_unit, flags.allowance, grain}));
    const PatternSheet sheet{!flags.plain, flags.interior, summary};
    CHECK_OK(WriteWanted(flags.svg, FormatPattern(pattern, sheet)));
    CHECK_OK(WriteWanted(flags.dxf, FormatDxf(pattern)));
  }
  return WriteWanted(flags.report, JsonReport(mesh, answer, flags.sigma));
}

Status Compare(const FlattenFlags& flags, const client::FlattenQuery& query,
               const SurfaceMesh& mesh, const client::Client& client) {
  const FlattenCall flatten = [&](const client::FlattenQuery& one, const std::string& what) {
    return FlattenWaiting(client, mesh, one, flags.timeout.value(), what);
  };
  TRY(const std::vector<ComparisonPanel> panels, CompareMethods(query, flatten));
  fmt::print("{}", FormatTable(panels));
  const std::string caption =
      fmt::format("{} vertices, {} triangles; the squares have one size on every layout",
                  mesh.vertices.size(), mesh.triangles.size());
  return WriteTextFile(flags.compare, FormatComparison(mesh, panels, caption));
}

Status Flatten(const FlattenFlags& flags) {
  TRY(const SurfaceFile file, ReadSurfaceFile(flags.surface));
  PrintWarnings(file.warnings);
  const SurfaceMesh& mesh = file.mesh;
  TRY(const client::FlattenQuery query,
      ReadQuery(flags, mesh.vertices.size(), mesh.triangles.size()));
  TRY(const Connection connection, Connection::Open(flags.server));

  const bool layout =
      !(flags.out.empty() && flags.svg.empty() && flags.dxf.empty() && flags.report.empty());
  if (layout) {
    const std::size_t slash = flags.job.find('/');
    TRY(const client::FlatSurface answer,
        flags.job.empty()
            ? FlattenWaiting(connection.client(), mesh, query, flags.timeout.value(), "flattening")
            : FlattenAsJob(connection.client(), mesh, query, flags.timeout.value(),
                           flags.job.substr(0, slash), flags.job.substr(slash + 1)));
    PrintWarnings(answer.flat.warnings);
    CHECK_OK(WriteLayout(flags, query.options.grain_lines, mesh, answer));
  }
  return flags.compare.empty() ? Status() : Compare(flags, query, mesh, connection.client());
}

}  // namespace

void AddFlatten(CLI::App& app, Run& run) {
  auto flags = std::make_shared<FlattenFlags>();
  CLI::App* const command = app.add_subcommand("flatten", "Lay a surface flat, true to size");
  AddFlattenFlags(*command, *flags);
  SetAction(*command, run, flags, &Flatten);
}

}  // namespace arap::cli
