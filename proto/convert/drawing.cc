// Drawings of layouts between the model and the wire.
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>

#include <arap/v1/flattening_service.pb.h>
#include <fmt/format.h>

#include "core/base/try.h"
#include "proto/convert/flatten.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

constexpr EnumRow<v1::DrawingFormat, DrawingFormat> kFormats[] = {
    {v1::DRAWING_FORMAT_SVG, DrawingFormat::kSvg},
    {v1::DRAWING_FORMAT_DXF, DrawingFormat::kDxf},
    {v1::DRAWING_FORMAT_PDF, DrawingFormat::kPdf},
};
static_assert(std::size(kFormats) == v1::DrawingFormat_ARRAYSIZE - 1);

constexpr EnumRow<v1::AllowanceCorners, Corners> kCorners[] = {
    {v1::ALLOWANCE_CORNERS_MITRE, Corners::kMitre},
    {v1::ALLOWANCE_CORNERS_SQUARE, Corners::kSquare},
    {v1::ALLOWANCE_CORNERS_ROUND, Corners::kRound},
};
static_assert(std::size(kCorners) == v1::AllowanceCorners_ARRAYSIZE - 1);

Result<DrawingOptions> OptionsOf(const v1::DrawingOptions& drawing, const std::string& path) {
  DrawingOptions options;
  if (drawing.format() == v1::DRAWING_FORMAT_UNSPECIFIED) {
    return Fail(UnknownValue(path + ".format", drawing.format()));
  }
  TRY(options.format, ModelOf(kFormats, drawing.format(), options.format, path + ".format"));
  TRY(options.corners, ModelOf(kCorners, drawing.corners(), options.corners, path + ".corners"));
  if (drawing.has_millimetres_per_unit()) {
    options.millimetres_per_unit = drawing.millimetres_per_unit();
  }
  options.allowance = drawing.allowance();
  options.notches = drawing.notches();
  options.sheet_width = drawing.sheet_width();
  options.paper = drawing.paper();
  if (drawing.has_overlap()) options.overlap = drawing.overlap();
  if (drawing.has_margin()) options.margin = drawing.margin();
  options.interior = drawing.interior();
  options.plain = drawing.plain();
  return options;
}

}  // namespace

Result<std::vector<DrawingOptions>> DrawingsFromWire(const v1::FlattenRequest& request) {
  const auto count = static_cast<std::size_t>(request.drawings_size());
  if (count > kMaxDrawings) {
    return Fail(
        Fault(FaultKind::kInvalidOption,
              fmt::format("{} drawings are asked for; at most {} are made.", count, kMaxDrawings))
            .Field("drawings")
            .Detail("count", count)
            .Detail("limit", kMaxDrawings));
  }
  std::vector<DrawingOptions> drawings;
  for (std::size_t i = 0; i < count; ++i) {
    TRY(drawings.emplace_back(),
        OptionsOf(request.drawings(static_cast<int>(i)), fmt::format("drawings[{}]", i)));
  }
  return drawings;
}

std::vector<NamedPart> PartsFromWire(const v1::FlattenRequest& request) {
  std::vector<NamedPart> parts;
  for (const v1::NamedPart& part : request.parts()) {
    parts.push_back({part.first_triangle(), part.name()});
  }
  return parts;
}

void ToWire(const std::vector<DrawingOptions>& drawings, const std::vector<NamedPart>& parts,
            v1::FlattenRequest* out) {
  for (const DrawingOptions& options : drawings) {
    v1::DrawingOptions& drawing = *out->add_drawings();
    drawing.set_format(WireOf(kFormats, options.format));
    drawing.set_millimetres_per_unit(options.millimetres_per_unit);
    drawing.set_allowance(options.allowance);
    drawing.set_corners(WireOf(kCorners, options.corners));
    drawing.set_notches(options.notches);
    drawing.set_sheet_width(options.sheet_width);
    drawing.set_paper(options.paper);
    drawing.set_overlap(options.overlap);
    drawing.set_margin(options.margin);
    drawing.set_interior(options.interior);
    drawing.set_plain(options.plain);
  }
  for (const NamedPart& part : parts) {
    v1::NamedPart& added = *out->add_parts();
    added.set_first_triangle(part.first_triangle);
    added.set_name(part.name);
  }
}

std::vector<Drawing> DrawingsFromWire(const v1::FlattenResponse& response) {
  std::vector<Drawing> drawings;
  for (const v1::Drawing& drawing : response.drawings()) {
    Drawing& added = drawings.emplace_back();
    for (const v1::DrawingFile& file : drawing.files()) {
      added.files.push_back({file.page(), file.data()});
    }
    added.warnings = FromWire(drawing.warnings());
  }
  return drawings;
}

void ToWire(std::vector<Drawing> drawings, v1::FlattenResponse* out) {
  for (Drawing& drawing : drawings) {
    v1::Drawing& added = *out->add_drawings();
    for (DrawingFile& file : drawing.files) {
      v1::DrawingFile& page = *added.add_files();
      page.set_page(std::move(file.page));
      page.set_data(std::move(file.bytes));
    }
    ToWire(drawing.warnings, added.mutable_warnings());
  }
}

}  // namespace arap::convert
