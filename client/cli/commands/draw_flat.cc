#include "client/cli/commands/draw_flat.h"

#include <cstddef>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/dxf.h"
#include "core/drawing/pattern_sheet.h"
#include "core/drawing/pdf.h"
#include "core/drawing/tiling.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

Status WriteSvgPages(const std::string& path, const Pattern& pattern,
                     const std::vector<Page>& pages) {
  const std::size_t dot = path.rfind('.');
  const bool ending = dot != std::string::npos && path.find('/', dot) == std::string::npos;
  const std::string stem = ending ? path.substr(0, dot) : path;
  const std::string suffix = ending ? path.substr(dot) : std::string();
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const std::string name = i == 0 ? "cover" : fmt::to_string(i);
    CHECK_OK(WriteTextFile(fmt::format("{}-{}{}", stem, name, suffix),
                           FormatPageSvg(pages[i], DigitsFor(pattern))));
  }
  return {};
}

}  // namespace

Status WriteDrawings(const DrawingFlags& flags, const Pattern& pattern,
                     const std::vector<std::string>& caption) {
  // What can be refused is made before anything is written.
  std::vector<Page> pages;
  if (!flags.paper.empty()) {
    TRY(const Paper paper, ParsePaper(flags.paper));
    TRY(pages, TilePages(pattern, paper, flags.overlap));
  }
  if (!flags.pdf.empty()) {
    TRY(const std::string pdf,
        FormatPdf(pages.empty() ? std::vector<Page>{SheetPage(pattern)} : pages));
    CHECK_OK(WriteTextFile(flags.pdf, pdf));
  }
  if (!flags.dxf.empty()) CHECK_OK(WriteTextFile(flags.dxf, FormatDxf(pattern)));
  if (flags.svg.empty()) return {};
  if (!pages.empty()) return WriteSvgPages(flags.svg, pattern, pages);
  return WriteTextFile(flags.svg, FormatPattern(pattern, {!flags.plain, flags.interior, caption}));
}

}  // namespace arap::cli
