// arapctl flatten: a surface laid flat, true to size.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "client/cli/commands/flatten_flags.h"
#include "client/cli/commands/flatten_report.h"
#include "client/cli/commands/lay_flat.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/drawing/captions.h"
#include "core/drawing/comparison.h"
#include "core/drawing/draw.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

// A file that is asked for, and what it is to be like.
struct Wanted {
  std::string path;
  DrawingOptions options;
};

std::vector<Wanted> WantedOf(const DrawingFlags& flags) {
  std::vector<Wanted> wanted;
  const auto add = [&](const std::string& path, DrawingFormat format) {
    if (path.empty()) return;
    Wanted& file = wanted.emplace_back(Wanted{path, flags.options});
    file.options.format = format;
    if (format != DrawingFormat::kDxf) return;
    file.options.interior = false;
    file.options.paper.clear();
  };
  add(flags.pdf, DrawingFormat::kPdf);
  add(flags.dxf, DrawingFormat::kDxf);
  add(flags.svg, DrawingFormat::kSvg);
  return wanted;
}

// "a.svg" and "cover" make "a-cover.svg".
std::string PathOf(const std::string& path, const std::string& page) {
  if (page.empty()) return path;
  std::size_t dot = path.rfind('.');
  if (dot == std::string::npos || path.find('/', dot) != std::string::npos) dot = path.size();
  return path.substr(0, dot) + "-" + page + path.substr(dot);
}

// What can be said before there is a layout: kInvalidOption for options that do not go together.
Status CheckDrawings(const DrawingFlags& flags) {
  for (const Wanted& file : WantedOf(flags)) CHECK_OK(CheckDrawing(file.options));
  return {};
}

// What the file calls its parts: by object where it has several, else by group, else by its one
// object. Empty where nothing has a name.
std::vector<NamedPart> PartsOf(const SurfaceFile& file) {
  bool groups = false, objects = false, several = false;
  for (const SurfacePart& part : file.parts) {
    groups = groups || !file.names[part.group].empty();
    objects = objects || !file.names[part.object].empty();
    several = several || file.names[part.object] != file.names[file.parts.front().object];
  }
  if (!groups && !objects) return {};
  const bool by_object = several || !groups;
  std::vector<NamedPart> parts;
  for (const SurfacePart& part : file.parts) {
    const std::uint32_t first = file.first_triangle[part.first_face];
    const std::string& name = file.names[by_object ? part.object : part.group];
    if (first >= file.mesh.triangles.size()) break;
    // A part whose faces have come to nothing gives way to the next.
    if (!parts.empty() && parts.back().first_triangle == first) parts.pop_back();
    if (parts.empty() || parts.back().name != name) parts.push_back({first, name});
  }
  return parts;
}

// Warnings of names that the files which are asked for cannot show.
std::vector<Warning> NameWarningsOf(const DrawingFlags& flags, const Pattern& pattern) {
  std::vector<Warning> warnings;
  for (const Wanted& file : WantedOf(flags)) {
    for (Warning& warning : NameWarnings(pattern, file.options.format)) {
      warnings.push_back(std::move(warning));
    }
  }
  return warnings;
}

// Writes what --svg, --dxf and --pdf ask for. With --paper an SVG is a file per page: "a.svg" is
// a-cover.svg, a-1.svg, a-2.svg, … `caption` goes under the colours. kInvalidOption for what paper
// or PDF cannot hold; kInternal with the path when a file cannot be written.
Status WriteDrawings(const DrawingFlags& flags, const Pattern& pattern,
                     const std::vector<std::string>& caption) {
  // What can be refused is made before anything is written.
  std::vector<std::pair<std::string, std::string>> texts;
  for (const Wanted& file : WantedOf(flags)) {
    TRY(std::vector<DrawingFile> files, FilesOf(pattern, file.options, caption));
    for (DrawingFile& page : files) {
      texts.emplace_back(PathOf(file.path, page.page), std::move(page.bytes));
    }
  }
  for (const auto& [path, text] : texts) CHECK_OK(WriteTextFile(path, text));
  return {};
}

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
