#include "core/drawing/draw.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"
#include "core/drawing/captions.h"
#include "core/drawing/page.h"
#include "core/drawing/pattern_files.h"

namespace arap {
namespace {

Fault Bad(std::string field, std::string message) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(std::move(field));
}

Status CheckNumber(const char* field, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return Fail(
      Bad(field, fmt::format("{} is {}; it must be {:g} to {:g}.", field, value, least, most)));
}

// Whether the triangles are coloured.
bool HasColours(const DrawingOptions& options) {
  return options.format != DrawingFormat::kDxf && options.paper.empty() && !options.plain;
}

bool Shows(DrawingFormat format, std::string_view text) {
  switch (format) {
    case DrawingFormat::kDxf:
      return DxfShows(text);
    case DrawingFormat::kPdf:
      return PdfShows(text);
    case DrawingFormat::kSvg:
      return true;
  }
  return true;
}

DrawingFile Whole(std::string bytes) { return {{}, std::move(bytes)}; }

}  // namespace

Status CheckDrawing(const DrawingOptions& options) {
  CHECK_OK(CheckNumber("millimetres_per_unit", options.millimetres_per_unit,
                       1 / kMaxMillimetresPerUnit, kMaxMillimetresPerUnit));
  CHECK_OK(CheckNumber("allowance", options.allowance, 0, kMaxAllowance));
  CHECK_OK(CheckNumber("sheet_width", options.sheet_width, 0, kMaxSheetWidth));
  if (options.interior && (options.format == DrawingFormat::kDxf || !options.paper.empty())) {
    return Fail(Bad("interior", "Only an SVG or PDF in one piece shows the edges inside."));
  }
  if (options.paper.empty()) return {};
  if (options.format == DrawingFormat::kDxf) {
    return Fail(Bad("paper", "A DXF has no pages."));
  }
  TRY(const Paper paper, ParsePaper(options.paper));
  return CheckPages(paper, options.overlap, options.margin);
}

Result<Pattern> PatternFor(const DrawingOptions& options, const Flattening& flat,
                           std::span<const GrainLine> grain_lines,
                           std::span<const std::string> names, const CancelToken& cancel) {
  constexpr double kFarthest = 1e12;
  for (const Complex p : flat.uv) {
    const double farther = std::max(std::abs(p.real()), std::abs(p.imag()));
    if (farther * options.millimetres_per_unit <= kFarthest) continue;
    return Fail(Bad("millimetres_per_unit",
                    fmt::format("A place of the drawing would be {:.3g} mm from 0; at most {:g} "
                                "can be drawn.",
                                farther * options.millimetres_per_unit, kFarthest)));
  }
  PatternOptions pattern;
  pattern.millimetres_per_unit = options.millimetres_per_unit;
  pattern.allowance = options.allowance;
  pattern.corners = options.corners;
  pattern.notches = options.notches;
  pattern.sheet_width = options.sheet_width;
  pattern.grain_lines = grain_lines;
  pattern.names = names;
  return MakePattern(flat, pattern, cancel);
}

Result<std::vector<DrawingFile>> FilesOf(const Pattern& pattern, const DrawingOptions& options,
                                         const std::vector<std::string>& caption,
                                         const CancelToken& cancel) {
  CHECK_OK(cancel.Check());
  if (options.format == DrawingFormat::kDxf) return std::vector{Whole(FormatDxf(pattern))};
  const PatternSheet sheet{HasColours(options), options.interior, caption};
  if (options.format == DrawingFormat::kSvg && options.paper.empty()) {
    return std::vector{Whole(FormatPattern(pattern, sheet))};
  }
  std::vector<Page> pages;
  if (options.paper.empty()) {
    pages.push_back(SheetPage(pattern, sheet));
  } else {
    TRY(const Paper paper, ParsePaper(options.paper));
    TRY(pages, TilePages(pattern, paper, options.overlap, options.margin));
  }
  CHECK_OK(cancel.Check());
  if (options.format == DrawingFormat::kPdf) {
    TRY(std::string pdf, FormatPdf(pages));
    return std::vector{Whole(std::move(pdf))};
  }
  std::vector<DrawingFile> files;
  for (const Page& page : pages) {
    files.push_back({page.number == 0 ? "cover" : fmt::to_string(page.number),
                     FormatPageSvg(page, DigitsFor(pattern))});
  }
  return files;
}

Result<Drawing> Draw(const DrawingOptions& options, const Flattening& flat,
                     std::span<const GrainLine> grain_lines, std::span<const std::string> names,
                     const CancelToken& cancel) {
  TRY(const Pattern pattern, PatternFor(options, flat, grain_lines, names, cancel));
  Drawing drawing;
  for (auto& more : {pattern.warnings, SizeWarnings(pattern, "millimetres_per_unit"),
                     NameWarnings(pattern, options.format)}) {
    drawing.warnings.insert(drawing.warnings.end(), more.begin(), more.end());
  }
  TRY(drawing.files, FilesOf(pattern, options, Summary(flat, pattern), cancel));
  return drawing;
}

std::vector<Warning> NameWarnings(const Pattern& pattern, DrawingFormat format) {
  constexpr std::size_t kNamed = 10;
  Warning warning{"unknown_characters", 0, {}, {}};
  for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
    const std::string& name = pattern.pieces[i].name;
    if (Shows(format, name)) continue;
    if (++warning.count <= kNamed) warning.elements.push_back(static_cast<std::uint32_t>(i));
    if (warning.count == 1) {
      warning.message =
          fmt::format("the {} has a question mark for characters in the name of piece {} ({})",
                      format == DrawingFormat::kPdf ? "PDF" : "DXF", i + 1, name);
    }
  }
  if (warning.count == 0) return {};
  if (warning.count > 1) {
    warning.message += fmt::format(" and in those of {} more", warning.count - 1);
  }
  return {warning};
}

DrawingCost EstimateDrawing(const DrawingOptions& options, std::size_t triangles,
                            std::size_t border) {
  struct PerElement {
    double micros = 0, bytes = 0;
    PerElement& operator+=(const PerElement& more) {
      micros += more.micros;
      bytes += more.bytes;
      return *this;
    }
  };
  PerElement triangle{0.2, 120}, point{2, 400};
  double bytes = 1e6;
  if (HasColours(options)) triangle += {1.5, 400};
  if (options.interior) triangle += {2, 400};
  if (options.allowance > 0) {
    point += options.corners == Corners::kRound ? PerElement{60, 4500} : PerElement{50, 3000};
  }
  if (options.notches) point += {1, 300};
  if (!options.paper.empty()) {
    point += {1, 400};
    bytes += 4e7;  // a thousand pages, and long lines on many of them
  }
  const auto t = static_cast<double>(triangles), p = static_cast<double>(border);
  return {1e-3 * (t * triangle.micros + p * point.micros),
          static_cast<std::size_t>(bytes + t * triangle.bytes + p * point.bytes)};
}

std::size_t LeastDrawingBytes(const DrawingOptions& options, std::size_t triangles) {
  // "M1 2L3 4L5 6Z"
  constexpr std::size_t kTriangle = 13;
  const bool is_text = options.format == DrawingFormat::kSvg;
  return is_text && HasColours(options) ? kTriangle * triangles : 0;
}

}  // namespace arap
