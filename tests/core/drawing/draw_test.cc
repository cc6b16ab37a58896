// From a layout to files: what options may be, which files come of them, what is told of them.
#include "core/drawing/draw.h"

#include <cmath>
#include <utility>

#include <gmock/gmock.h>

#include "core/drawing/captions.h"

namespace arap {
namespace {

using testing::_;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// A right triangle with sides of 3 and 4, cut along two of its sides.
Flattening FlatTriangle() {
  Flattening flat;
  flat.uv = {{0, 0}, {3, 0}, {0, 4}};
  flat.source = {0, 1, 2};
  flat.corner_uv = {{0, 1, 2}};
  flat.singular_values = {{1.1, 1}};
  flat.triangle_chart = {0};
  flat.charts.resize(1);
  flat.charts[0].loops = {{0, 1, 2}};
  flat.charts[0].triangles = 1;
  return flat;
}

DrawingOptions InCentimetres(DrawingFormat format) {
  DrawingOptions options;
  options.format = format;
  options.millimetres_per_unit = 10;
  return options;
}

TEST(CheckDrawing, OptionsOutOfTheirRangeAreNamed) {
  using Change = void (*)(DrawingOptions&);
  const std::pair<const char*, Change> cases[] = {
      {"millimetres_per_unit", [](DrawingOptions& o) { o.millimetres_per_unit = 0; }},
      {"millimetres_per_unit", [](DrawingOptions& o) { o.millimetres_per_unit = -1; }},
      {"millimetres_per_unit", [](DrawingOptions& o) { o.millimetres_per_unit = 1e7; }},
      {"millimetres_per_unit", [](DrawingOptions& o) { o.millimetres_per_unit = NAN; }},
      {"allowance", [](DrawingOptions& o) { o.allowance = -1; }},
      {"allowance", [](DrawingOptions& o) { o.allowance = INFINITY; }},
      {"sheet_width", [](DrawingOptions& o) { o.sheet_width = -1; }},
      {"sheet_width", [](DrawingOptions& o) { o.sheet_width = NAN; }},
      {"paper", [](DrawingOptions& o) { o.paper = "A9"; }},
      {"paper", [](DrawingOptions& o) { o.paper = std::string(100'000, 'A'); }},
      {"overlap", [](DrawingOptions& o) { o.paper = "A4", o.overlap = 96; }},
      {"overlap", [](DrawingOptions& o) { o.paper = "A4", o.overlap = NAN; }},
      {"margin", [](DrawingOptions& o) { o.paper = "A4", o.margin = 21; }},
      {"margin", [](DrawingOptions& o) { o.paper = "A4", o.margin = -1; }},
      {"interior", [](DrawingOptions& o) { o.paper = "A4", o.interior = true; }},
      {"interior", [](DrawingOptions& o) { o.format = DrawingFormat::kDxf, o.interior = true; }},
      {"paper", [](DrawingOptions& o) { o.format = DrawingFormat::kDxf, o.paper = "A4"; }},
  };
  EXPECT_TRUE(CheckDrawing({}));
  for (const auto& [field, change] : cases) {
    DrawingOptions options;
    change(options);
    const Status refused = CheckDrawing(options);
    ASSERT_FALSE(refused) << field;
    EXPECT_EQ(refused.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(refused.error().field, field);
    EXPECT_LT(refused.error().message.size(), 300u);
  }
}

TEST(Draw, EveryFormatIsAFile) {
  const auto bytes = [](const DrawingOptions& options) {
    const Result<Drawing> drawing = Draw(options, FlatTriangle(), {}, {});
    EXPECT_TRUE(drawing) << drawing.error().message;
    if (!drawing || drawing->files.size() != 1) return std::string();
    EXPECT_EQ(drawing->files[0].page, "");
    EXPECT_TRUE(drawing->warnings.empty());
    return drawing->files[0].bytes;
  };
  DrawingOptions svg = InCentimetres(DrawingFormat::kSvg);
  EXPECT_THAT(bytes(svg), HasSubstr("sheet: 30.000 × 40.000 mm</text>"));
  svg.plain = true;
  EXPECT_THAT(bytes(svg), HasSubstr("viewBox=\"0 0 50 60\""));
  EXPECT_THAT(bytes(svg), Not(HasSubstr("<text")));
  EXPECT_THAT(bytes(InCentimetres(DrawingFormat::kDxf)), HasSubstr("OUTLINE"));
  DrawingOptions pdf = InCentimetres(DrawingFormat::kPdf);
  EXPECT_THAT(bytes(pdf), HasSubstr("/Count 1"));
  pdf.paper = "A4";
  EXPECT_THAT(bytes(pdf), HasSubstr("/Count 2"));
}

TEST(Draw, PagesOfAnSvgAreFilesOfTheirOwn) {
  DrawingOptions options = InCentimetres(DrawingFormat::kSvg);
  options.paper = "100x100";
  const Result<Drawing> drawing = Draw(options, FlatTriangle(), {}, {});
  ASSERT_TRUE(drawing) << drawing.error().message;
  ASSERT_EQ(drawing->files.size(), 2u);
  EXPECT_EQ(drawing->files[0].page, "cover");
  EXPECT_THAT(drawing->files[0].bytes, HasSubstr("Sheet of 30.0 × 40.0 mm"));
  EXPECT_EQ(drawing->files[1].page, "1");
}

TEST(Draw, WhatIsDoubtfulIsTold) {
  const auto kinds = [](const DrawingOptions& options, const std::string& name) {
    std::vector<std::string> told;
    const std::vector<std::string> names{name};
    const Result<Drawing> drawing = Draw(options, FlatTriangle(), {}, names);
    EXPECT_TRUE(drawing) << drawing.error().message;
    if (!drawing) return told;
    for (const Warning& warning : drawing->warnings) {
      EXPECT_THAT(warning.elements, ElementsAre(0));
      told.push_back(warning.kind);
    }
    return told;
  };
  EXPECT_THAT(kinds({}, ""), ElementsAre("unlikely_size"));
  // Greek is beyond the font of PDF, and what is beyond the basic plane has no code in DXF.
  EXPECT_THAT(kinds(InCentimetres(DrawingFormat::kPdf), "Ärmel €"), ElementsAre());
  EXPECT_THAT(kinds(InCentimetres(DrawingFormat::kPdf), "μανίκι"),
              ElementsAre("unknown_characters"));
  EXPECT_THAT(kinds(InCentimetres(DrawingFormat::kDxf), "μανίκι"), ElementsAre());
  EXPECT_THAT(kinds(InCentimetres(DrawingFormat::kDxf), "👗"), ElementsAre("unknown_characters"));
  EXPECT_THAT(kinds(InCentimetres(DrawingFormat::kSvg), "👗"), ElementsAre());
}

TEST(Draw, EndsWhenItIsCancelled) {
  const CancelToken cancel(
      [] { return Status(Fail(FaultKind::kCancelled, "The caller gave up.")); });
  for (const DrawingFormat format :
       {DrawingFormat::kSvg, DrawingFormat::kDxf, DrawingFormat::kPdf}) {
    const Result<Drawing> ended = Draw(InCentimetres(format), FlatTriangle(), {}, {}, cancel);
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().kind, FaultKind::kCancelled);
  }
}

TEST(Draw, PlacesThatNoFileHoldsAreRefused) {
  Flattening flat = FlatTriangle();
  flat.uv[0] = {-1e250, 0};
  const Result<Drawing> refused = Draw({}, flat, {}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().field, "millimetres_per_unit");
}

TEST(Draw, TellsAtLeastHowLargeItIs) {
  const DrawingOptions options = InCentimetres(DrawingFormat::kSvg);
  const Result<Drawing> drawing = Draw(options, FlatTriangle(), {}, {});
  ASSERT_TRUE(drawing);
  EXPECT_GT(LeastDrawingBytes(options, 1), 0u);
  EXPECT_LE(LeastDrawingBytes(options, 1), drawing->files[0].bytes.size());
  EXPECT_GT(EstimateDrawing(options, 1000, 100).bytes, EstimateDrawing(options, 10, 10).bytes);
}

TEST(Summary, TellsOfCutsOverlapsAndSizes) {
  Flattening flat = FlatTriangle();
  flat.cuts = {{0, 1}, {2, 1}};
  flat.auto_cuts = 1;
  flat.overlaps = true;
  const std::vector<std::string> names{"sleeve"};
  const auto lines = [&] {
    return Summary(flat, *PatternFor(InCentimetres(DrawingFormat::kSvg), flat, {}, names));
  };
  EXPECT_THAT(
      lines(),
      ElementsAre(
          HasSubstr("3 vertices, 1 triangles"), _, _,
          HasSubstr("1 piece, 2 edges cut, 1 of them automatically; the outline overlaps itself"),
          "piece 1 (sleeve): 30.000 × 40.000 mm", "sheet: 30.000 × 40.000 mm"));
  flat.cuts.clear();
  flat.overlaps = false;
  EXPECT_EQ(lines().size(), 5u);
}

TEST(Summary, TellsOfRefinementsThatReachedTheirLimit) {
  Flattening flat = FlatTriangle();
  const auto lines = [&] {
    return Summary(flat, *PatternFor(InCentimetres(DrawingFormat::kSvg), flat, {}, {}));
  };
  const auto told = Contains("refined 7 times, the limit: not converged");
  flat.charts[0].refinements = 7;
  flat.charts[0].refine_end = RefineEnd::kConverged;
  EXPECT_THAT(lines(), Not(told));
  flat.charts[0].refine_end = RefineEnd::kLimit;
  EXPECT_THAT(lines(), told);
}

TEST(SizeWarnings, UnlikelySizesNameTheUnit) {
  const auto warned = [](double millimetres_per_unit) {
    return SizeWarnings(*MakePattern(FlatTriangle(), {millimetres_per_unit, 0, {}}), "--unit");
  };
  for (const double likely : {1.3, 10.0, 2400.0}) EXPECT_TRUE(warned(likely).empty()) << likely;
  for (const double unlikely : {0.001, 1.2, 2600.0}) {
    const std::vector<Warning> warnings = warned(unlikely);
    ASSERT_EQ(warnings.size(), 1u) << unlikely;
    EXPECT_EQ(warnings[0].count, 1u);
    EXPECT_THAT(warnings[0].elements, ElementsAre(0));
    EXPECT_THAT(warnings[0].message, HasSubstr("Piece 1 is "));
    EXPECT_THAT(warnings[0].message, HasSubstr("--unit"));
  }
}

}  // namespace
}  // namespace arap
