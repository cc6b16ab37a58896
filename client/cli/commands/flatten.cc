// arapctl flatten: a surface laid flat, true to size.
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/draw_flat.h"
#include "client/cli/commands/flatten_flags.h"
#include "client/cli/commands/flatten_report.h"
#include "client/cli/commands/lay_flat.h"
#include "client/cli/reply.h"
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
Status WriteSurface(const FlattenFlags& flags, const SurfaceFile& file, const Flattening& flat,
                    std::vector<Warning>& warnings) {
  if (flags.out.empty()) return {};
  const bool unit = flags.vt == FlattenFlags::Vt::kUnit;
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

// Writes what is asked for. Answers the summary and the report.
Result<Reply> WriteLayout(const FlattenFlags& flags, const std::vector<GrainLine>& grain,
                          const SurfaceFile& file, const Counting& counting,
                          client::FlatSurface answer) {
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
  CHECK_OK(WriteDrawings(drawing, pattern, summary));
  std::vector<Warning> of_files;
  CHECK_OK(WriteSurface(flags, file, flat, of_files));
  Reply reply{ReportJson(mesh, answer, pattern, flags.sigma), {}};
  if (!flags.report.empty()) CHECK_OK(WriteTextFile(flags.report, JsonText(reply.json)));
  for (const std::string& line : summary) reply.text += line + "\n";
  // What was said of the files too, which is no part of the report.
  of_files.insert(of_files.begin(), file.warnings.begin(), file.warnings.end());
  for (OrderedJson& warning : WarningsJson(of_files)) reply.json["warnings"].push_back(warning);
  return reply;
}

Status Compare(const FlattenFlags& flags, const client::FlattenQuery& query,
               const SurfaceMesh& mesh, const client::Client& client,
               const std::vector<Origin>& origins, Reply& reply) {
  const FlattenCall flatten = [&](const client::FlattenQuery& one, const std::string& what) {
    return InOwnWords(FlattenWaiting(client, mesh, one, flags.timeout.value(), what), origins);
  };
  TRY(const std::vector<ComparisonPanel> panels, CompareMethods(query, flatten));
  reply.text += FormatTable(panels);
  reply.json["comparison"] = ComparisonJson(panels);
  const std::string caption =
      fmt::format("{} vertices, {} triangles; the squares have one size on every layout",
                  mesh.vertices.size(), mesh.triangles.size());
  return WriteTextFile(flags.compare, FormatComparison(mesh, panels, caption));
}

Result<Reply> Flatten(const FlattenFlags& flags) {
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
                        drawing.pdf.empty() && flags.report.empty() && !flags.json);
  Reply reply;
  if (layout) {
    const std::size_t slash = flags.job.find('/');
    TRY(client::FlatSurface answer,
        InOwnWords(flags.job.empty()
                       ? FlattenWaiting(connection.client(), mesh, query, flags.timeout.value(),
                                        "flattening")
                       : FlattenAsJob(connection.client(), mesh, query, flags.timeout.value(),
                                      flags.job.substr(0, slash), flags.job.substr(slash + 1)),
                   origins));
    TRY(reply, WriteLayout(flags, query.options.grain_lines, file, counting, std::move(answer)));
  }
  if (!flags.compare.empty()) {
    CHECK_OK(Compare(flags, query, mesh, connection.client(), origins, reply));
  }
  return reply;
}

}  // namespace

void AddFlatten(CLI::App& app, Run& run) {
  auto flags = std::make_shared<FlattenFlags>();
  CLI::App* const command = app.add_subcommand("flatten", "Lay a surface flat, true to size");
  AddFlattenFlags(*command, *flags);
  command->callback(
      [&run, flags] { run = [flags] { return Finish(Flatten(*flags), flags->json); }; });
}

}  // namespace arap::cli
