// Drawings of flat surfaces for C.
#include <string>
#include <utility>

#include "client/c/objects.h"

namespace client = arap::client;

namespace arap::c {
namespace {

Result<client::DrawingFormat> FormatOf(std::int32_t format, const std::string& field) {
  switch (format) {
    case ARAP_SVG:
      return client::DrawingFormat::kSvg;
    case ARAP_DXF:
      return client::DrawingFormat::kDxf;
    case ARAP_PDF:
      return client::DrawingFormat::kPdf;
    default:
      return Fail(BadChoice(field + ".format", "is no format", format));
  }
}

Result<client::Corners> CornersOf(std::int32_t corners, const std::string& field) {
  switch (corners) {
    case ARAP_CORNERS_DEFAULT:
    case ARAP_CORNERS_MITRE:
      return client::Corners::kMitre;
    case ARAP_CORNERS_SQUARE:
      return client::Corners::kSquare;
    case ARAP_CORNERS_ROUND:
      return client::Corners::kRound;
    default:
      return Fail(BadChoice(field + ".corners", "are no corners", corners));
  }
}

// 0: the default; below 0: none.
double LengthOf(double given, double standard) {
  if (given == 0) return standard;
  return given < 0 ? 0 : given;
}

Result<client::DrawingOptions> DrawingOf(const arap_drawing_options* options,
                                         const std::string& field) {
  CHECK_OK(Need(options, field.c_str()));
  TRY(const auto given, OptionsOf(options, field.c_str()));
  client::DrawingOptions ours;
  TRY(ours.format, FormatOf(given.format, field));
  TRY(ours.corners, CornersOf(given.corners, field));
  ours.millimetres_per_unit = given.millimetres_per_unit == 0 ? 1 : given.millimetres_per_unit;
  ours.allowance = given.allowance;
  ours.notches = given.notches != 0;
  ours.sheet_width = given.sheet_width;
  ours.paper = TextOf(given.paper);
  ours.overlap = LengthOf(given.overlap, ours.overlap);
  ours.margin = LengthOf(given.margin, ours.margin);
  ours.interior = given.interior != 0;
  ours.plain = given.plain != 0;
  return ours;
}

// A file, or nothing past the end.
const client::DrawingFile* FileOf(const arap_flat* flat, std::size_t drawing, std::size_t file) {
  if (file >= arap_flat_file_count(flat, drawing)) return nullptr;
  return &flat->drawings[drawing].files[file];
}

}  // namespace

Status FillDrawings(const arap_flatten_options& given, client::FlattenQuery& query) {
  TRY(const auto drawings, ArrayOf(given.drawings, given.drawing_count, "drawings"));
  for (const arap_drawing_options* drawing : drawings) {
    const std::string field = "drawings[" + std::to_string(query.drawings.size()) + "]";
    TRY(auto ours, DrawingOf(drawing, field));
    query.drawings.push_back(std::move(ours));
  }
  TRY(const auto parts, ArrayOf(given.parts, given.part_count, "parts"));
  for (const arap_part& part : parts) {
    query.parts.push_back({part.first_triangle, TextOf(part.name)});
  }
  return {};
}

}  // namespace arap::c

extern "C" {

size_t arap_flat_drawing_count(const arap_flat* flat) { return flat->drawings.size(); }
const arap_warnings* arap_flat_drawing_warnings(const arap_flat* flat, size_t drawing) {
  return drawing < flat->drawings.size() ? &flat->drawings[drawing].warnings : nullptr;
}
size_t arap_flat_file_count(const arap_flat* flat, size_t drawing) {
  return drawing < flat->drawings.size() ? flat->drawings[drawing].files.size() : 0;
}
const char* arap_flat_file_page(const arap_flat* flat, size_t drawing, size_t file) {
  const auto* const found = arap::c::FileOf(flat, drawing, file);
  return found != nullptr ? found->page.c_str() : nullptr;
}
const char* arap_flat_file_bytes(const arap_flat* flat, size_t drawing, size_t file) {
  const auto* const found = arap::c::FileOf(flat, drawing, file);
  return found != nullptr ? found->bytes.data() : nullptr;
}
size_t arap_flat_file_size(const arap_flat* flat, size_t drawing, size_t file) {
  const auto* const found = arap::c::FileOf(flat, drawing, file);
  return found != nullptr ? found->bytes.size() : 0;
}

}  // extern "C"
