#include "client/cli/commands/flatten_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/flatten_inputs.h"

namespace arap::cli {
namespace {

using testing::_;
using testing::ElementsAre;
using testing::HasSubstr;

const SurfaceMesh kTriangle{{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};

client::FlatSurface FlatTriangle() {
  client::FlatSurface answer;
  Flattening& flat = answer.flat;
  flat.uv = {{0, 0}, {3, 0}, {0, 4}};
  flat.source = {0, 1, 2};
  flat.corner_uv = {{0, 1, 2}};
  flat.singular_values = {{1, 1}};
  flat.triangle_chart = {0};
  flat.charts.resize(1);
  flat.charts[0].loops = {{0, 1, 2}};
  flat.charts[0].triangles = 1;
  flat.charts[0].refinements = 3;
  flat.charts[0].refine_end = RefineEnd::kLimit;
  flat.charts[0].distortion.arap_energy = 0.25;
  flat.distortion.worst_triangle = 7;
  flat.cuts = {{0, 1}, {2, 1}};
  flat.auto_cuts = 1;
  flat.degenerate = {5};
  flat.overlaps = true;
  flat.warnings.push_back({"unreferenced_vertices", 2, {8, 9}, "2 vertices"});
  answer.solve_micros = 12.5;
  return answer;
}

Pattern Drawn(const client::FlatSurface& answer, double millimetres_per_unit = 10) {
  const Result<Pattern> pattern = MakePattern(answer.flat, {millimetres_per_unit, 0, {}});
  EXPECT_TRUE(pattern);
  return pattern ? *pattern : Pattern();
}

std::string Report(const client::FlatSurface& answer, bool sigma = false) {
  return ReportJson(kTriangle, answer, Drawn(answer), sigma).dump();
}

TEST(FlattenReport, HasEverythingThatIsKnown) {
  const auto report = nlohmann::json::parse(Report(FlatTriangle()));
  EXPECT_EQ(report["vertices"], 3);
  EXPECT_EQ(report["distortion"]["worst_triangle"], 7);
  ASSERT_EQ(report["charts"].size(), 1u);
  const auto& chart = report["charts"][0];
  EXPECT_EQ(chart["boundaries"][0]["positions"], 3);
  EXPECT_EQ(chart["boundaries"][0]["length"], 12);
  EXPECT_EQ(chart["refinements"], 3);
  EXPECT_EQ(chart["refine_end"], "limit");
  EXPECT_EQ(chart["size_mm"], nlohmann::json::parse("[30.0, 40.0]"));
  EXPECT_EQ(report["sheet_mm"], nlohmann::json::parse("[30.0, 40.0]"));
  EXPECT_EQ(chart["distortion"]["arap_energy"], 0.25);
  EXPECT_EQ(report["cut_edges"], nlohmann::json::parse("[[0, 1], [2, 1]]"));
  EXPECT_EQ(report["auto_cut_count"], 1);
  EXPECT_EQ(report["left_out_triangles"][0], 5);
  EXPECT_EQ(report["boundary_overlaps"], true);
  EXPECT_EQ(report["warnings"][0]["elements"][1], 9);
  EXPECT_EQ(report["solve_micros"], 12.5);
}

TEST(FlattenReport, ListsEveryTriangleOnRequest) {
  client::FlatSurface flat = FlatTriangle();
  flat.flat.singular_values = {{1.5, -0.25}};
  EXPECT_FALSE(nlohmann::json::parse(Report(flat)).contains("singular_values"));
  const auto report = nlohmann::json::parse(Report(flat, true));
  EXPECT_EQ(report["singular_values"], nlohmann::json::parse("[[1.5, -0.25]]"));
}

TEST(FlattenReport, IsAFileOfSeams) {
  const auto seams = ParseSeams(Report(FlatTriangle()), "report.json", 3);
  ASSERT_TRUE(seams) << seams.error().message;
  EXPECT_THAT(*seams, ElementsAre(ElementsAre(0, 1), ElementsAre(2, 1)));
}

}  // namespace
}  // namespace arap::cli
