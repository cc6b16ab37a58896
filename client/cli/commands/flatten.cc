// arapctl flatten: a surface laid flat, true to size.
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/draw_flat.h"
#include "client/cli/commands/flatten_flags.h"
#include "client/cli/commands/flatten_report.h"
#include "client/cli/commands/lay_flat.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/drawing/comparison.h"
#include "core/drawing/draw.h"
#include "core/drawing/piece_names.h"
#include "core/drawing/summary.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_layout.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

// The surface with its layout, as --out and --vt want it.
Status WriteSurface(const FlattenFlags& flags, const SurfaceFile& file, const Flattening& flat) {
  if (flags.out.empty()) return {};
  const bool unit = flags.vt == FlattenFlags::Vt::kUnit;
  std::vector<Warning> warnings;
  const std::string text =
      FormatLayout(file, unit ? InUnitSquare(flat.uv) : flat.uv, flat.corner_uv, warnings);
  if (file.text.empty()) {
    Warning& warning = warnings.emplace_back();
    warning.kind = "written_anew";
    warning.count = 1;
    warning.message = fmt::format(
        "{} is written anew, with the vertices, faces and objects of {}{}", flags.out,
        flags.surface, file.has_extras ? "; colours, normals and the like are not kept" : "");
  }
  PrintWarnings(warnings);
  return WriteTextFile(flags.out, text);
}

Status WriteLayout(const FlattenFlags& flags, const std::vector<GrainLine>& grain,
                   const SurfaceFile& file, const Counting& counting, client::FlatSurface answer) {
  const SurfaceMesh& mesh = file.mesh;
  const Flattening& flat = answer.flat;
  const DrawingFlags& drawing = flags.drawing;
  TRY(const Pattern pattern,
      PatternFor(drawing.options, flat, grain, PieceNames(flat, PartsOf(file))));
  // The report counts from 0, as all of it does.
  PrintWarnings(InOwnWords(flat.warnings, counting));
  for (const auto& more :
       {pattern.warnings, SizeWarnings(pattern, "--unit"), NameWarningsOf(drawing, pattern)}) {
    PrintWarnings(more);
    answer.flat.warnings.insert(answer.flat.warnings.end(), more.begin(), more.end());
  }
  const std::vector<std::string> summary = Summary(flat, pattern);
  for (const std::string& line : summary) Say(line + "\n");
  CHECK_OK(WriteDrawings(drawing, pattern, summary));
  CHECK_OK(WriteSurface(flags, file, flat));
  if (flags.report.empty()) return {};
  return WriteTextFile(flags.report, JsonReport(mesh, answer, pattern, flags.sigma));
}

Status Compare(const FlattenFlags& flags, const client::FlattenQuery& query,
               const SurfaceMesh& mesh, const client::Client& client,
               const std::vector<Origin>& origins) {
  const FlattenCall flatten = [&](const client::FlattenQuery& one, const std::string& what) {
    return InOwnWords(FlattenWaiting(client, mesh, one, flags.timeout.value(), what), origins);
  };
  TRY(const std::vector<ComparisonPanel> panels, CompareMethods(query, flatten));
  Say(FormatTable(panels));
  const std::string caption =
      fmt::format("{} vertices, {} triangles; the squares have one size on every layout",
                  mesh.vertices.size(), mesh.triangles.size());
  return WriteTextFile(flags.compare, FormatComparison(mesh, panels, caption));
}

Status Flatten(const FlattenFlags& flags) {
  TRY(const SurfaceFile file, ReadSurfaceFile(flags.surface));
  PrintWarnings(file.warnings);
  const SurfaceMesh& mesh = file.mesh;
  TRY(const FlattenTexts texts, ReadTexts(flags));
  const Counting counting = CountingOf(file);
  const std::vector<Origin> origins = OriginsOf(flags, texts, counting);
  TRY(const client::FlattenQuery query,
      InOwnWords(ReadQuery(flags, texts, mesh.vertices.size(), mesh.triangles.size()), origins));
  CHECK_OK(CheckDrawings(flags.drawing));
  TRY(const Connection connection, Connection::Open(flags.server));

  const DrawingFlags& drawing = flags.drawing;
  const bool layout = !(flags.out.empty() && drawing.svg.empty() && drawing.dxf.empty() &&
                        drawing.pdf.empty() && flags.report.empty());
  if (layout) {
    const std::size_t slash = flags.job.find('/');
    TRY(client::FlatSurface answer,
        InOwnWords(flags.job.empty()
                       ? FlattenWaiting(connection.client(), mesh, query, flags.timeout.value(),
                                        "flattening")
                       : FlattenAsJob(connection.client(), mesh, query, flags.timeout.value(),
                                      flags.job.substr(0, slash), flags.job.substr(slash + 1)),
                   origins));
    CHECK_OK(WriteLayout(flags, query.options.grain_lines, file, counting, std::move(answer)));
  }
  return flags.compare.empty() ? Status()
                               : Compare(flags, query, mesh, connection.client(), origins);
}

}  // namespace

void AddFlatten(CLI::App& app, Run& run) {
  auto flags = std::make_shared<FlattenFlags>();
  CLI::App* const command = app.add_subcommand("flatten", "Lay a surface flat, true to size");
  AddFlattenFlags(*command, *flags);
  SetAction(*command, run, flags, &Flatten);
}

}  // namespace arap::cli
