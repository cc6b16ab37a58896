#include "client/cli/commands/draw_flat.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/draw.h"
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

}  // namespace

Status CheckDrawings(const DrawingFlags& flags) {
  for (const Wanted& file : WantedOf(flags)) CHECK_OK(CheckDrawing(file.options));
  return {};
}

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

std::vector<Warning> NameWarningsOf(const DrawingFlags& flags, const Pattern& pattern) {
  std::vector<Warning> warnings;
  for (const Wanted& file : WantedOf(flags)) {
    for (Warning& warning : NameWarnings(pattern, file.options.format)) {
      warnings.push_back(std::move(warning));
    }
  }
  return warnings;
}

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

}  // namespace arap::cli
