// Patterns at true size: what is drawn, and that SVG and DXF files say it in millimetres.
#include "core/drawing/pattern.h"

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "core/base/plane.h"
#include "core/drawing/pattern_files.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Two pieces: the square 0 1 2 3 of side 4 cut along its diagonal 0 2, which vertices 4 and 5
// double, the second triangle moved away.
Flattening CutSquare(double away = 10) {
  Flattening flat;
  flat.uv = {{0, 0}, {4, 0}, {4, 4}, {away, 4}, {away, 0}, {away + 4, 4}};
  flat.source = {0, 1, 2, 3, 0, 2};
  flat.corner_uv = {{0, 1, 2}, {4, 5, 3}};
  flat.triangle_chart = {0, 1};
  flat.singular_values = {{1, 1}, {1.04, 0.99}};
  flat.cuts = {{2, 0}};
  flat.charts.resize(2);
  flat.charts[0].loops = {{0, 1, 2}};
  flat.charts[1].loops = {{4, 5, 3}};
  return flat;
}

template <class T>
T ValueOf(const Result<T>& result) {
  EXPECT_TRUE(result) << result.error().message;
  return result ? *result : T{};
}

Pattern Made(const Flattening& flat, const PatternOptions& options) {
  return ValueOf(MakePattern(flat, options));
}

using Polyline = std::vector<Complex>;

double Length(const Polyline& line, bool closed) {
  double length = 0;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i) {
    length += std::abs(line[i] - line[(i + 1) % line.size()]);
  }
  return length;
}

double Area(const Polyline& line) {
  double twice = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    twice += (std::conj(line[i]) * line[(i + 1) % line.size()]).imag();
  }
  return twice / 2;
}

struct DxfEntity {
  std::string type, layer;
  bool closed = false;
  Polyline points;
};

struct DxfFile {
  std::map<std::string, std::string> header;  // of each variable the first value
  std::vector<std::string> layers;
  std::vector<DxfEntity> entities;
};

// Reads what FormatDxf writes, as a stranger would: pairs of lines.
DxfFile ReadDxf(const std::string& text) {
  DxfFile file;
  std::istringstream lines(text);
  std::string section, type, variable;
  std::set<std::string> handles;
  for (std::string head, value; std::getline(lines, head) && std::getline(lines, value);) {
    const int code = std::stoi(head);
    if (code == 0) type = value;
    if (code == 2 && type == "SECTION") section = value;
    if (section == "HEADER" && code == 9) variable = value;
    if (section == "HEADER" && code != 9) file.header.try_emplace(variable, value);
    if (section != "HEADER" && (code == 5 || code == 105)) {
      EXPECT_TRUE(handles.insert(value).second) << "the handle " << value << " is there twice";
    }
    if (code == 2 && type == "LAYER") file.layers.push_back(value);
    if (section != "ENTITIES") continue;
    if (code == 0 && (value == "LWPOLYLINE" || value == "LINE")) {
      file.entities.push_back({value, {}, {}, {}});
    }
    if (file.entities.empty()) continue;
    DxfEntity& entity = file.entities.back();
    if (code == 8) entity.layer = value;
    if (code == 70) entity.closed = value == "1";
    if (code == 10 || code == 11) entity.points.emplace_back(std::stod(value), 0);
    if (code == 20 || code == 21) entity.points.back().imag(std::stod(value));
  }
  EXPECT_EQ(type, "EOF");
  return file;
}

// The paths of a group, each M x y L x y … and perhaps Z.
std::vector<std::pair<Polyline, bool>> Paths(const std::string& svg, const std::string& id) {
  std::vector<std::pair<Polyline, bool>> paths;
  const std::size_t begin = svg.find("<g id=\"" + id + "\"");
  if (begin == std::string::npos) return paths;
  const std::size_t end = svg.find("</g>", begin);
  const std::string lead = " d=\"";
  for (std::size_t at = svg.find(lead, begin); at < end; at = svg.find(lead, at + 1)) {
    std::string data =
        svg.substr(at + lead.size(), svg.find('"', at + lead.size()) - at - lead.size());
    const bool closed = data.ends_with('Z');
    for (char& c : data) {
      if (c == 'M' || c == 'L' || c == 'Z') c = ' ';
    }
    std::istringstream numbers(data);
    Polyline line;
    for (double x = 0, y = 0; numbers >> x >> y;) line.emplace_back(x, y);
    paths.emplace_back(line, closed);
  }
  return paths;
}

// The lines of a kind of all pieces, closed ones with their first point repeated.
std::vector<Polyline> LinesOf(const Pattern& pattern, LineKind kind) {
  std::vector<Polyline> lines;
  for (const PatternPiece& piece : pattern.pieces) {
    for (const PatternLine& line : piece.lines) {
      if (line.kind != kind) continue;
      lines.push_back(line.points);
      if (line.closed) lines.back().push_back(line.points.front());
    }
  }
  return lines;
}

TEST(Pattern, HasOutlinesSeamsAndGrainInMillimetres) {
  const std::vector<GrainLine> grain{{0, 1, 0}, {2, 3, std::numbers::pi}, {1, 3, 0}};
  const Pattern pattern = Made(CutSquare(), {10, 0, grain});
  EXPECT_EQ(pattern.points[1], Complex(40, 0));
  // The outline goes on where the seam ends, and is nowhere drawn below it.
  EXPECT_THAT(LinesOf(pattern, LineKind::kOutline),
              ElementsAre(ElementsAre(Complex(0, 0), Complex(40, 0), Complex(40, 40)),
                          ElementsAre(Complex(140, 40), Complex(100, 40), Complex(100, 0))));
  EXPECT_THAT(LinesOf(pattern, LineKind::kSeam),
              ElementsAre(ElementsAre(Complex(40, 40), Complex(0, 0)),
                          ElementsAre(Complex(100, 0), Complex(140, 40))));
  // Each on the piece that has both ends; 1 and 3 are on different ones.
  EXPECT_THAT(LinesOf(pattern, LineKind::kGrain),
              ElementsAre(ElementsAre(Complex(0, 0), Complex(40, 0)),
                          ElementsAre(Complex(140, 40), Complex(100, 40))));
  EXPECT_TRUE(LinesOf(pattern, LineKind::kAllowance).empty());
  ASSERT_EQ(pattern.pieces.size(), 2u);
  EXPECT_EQ(pattern.pieces[1].box.min_x, 100);
  EXPECT_EQ(pattern.pieces[1].box.width(), 40);
  EXPECT_EQ(pattern.Box().width(), 140);
}

TEST(Pattern, ALoopOfCutsIsOneSeam) {
  Flattening flat = CutSquare();
  flat.cuts = {{0, 1}, {1, 2}, {0, 2}};
  const Pattern pattern = Made(flat, {});
  EXPECT_THAT(LinesOf(pattern, LineKind::kSeam),
              ElementsAre(testing::SizeIs(4), ElementsAre(Complex(10, 0), Complex(14, 4))));
  EXPECT_THAT(LinesOf(pattern, LineKind::kOutline), ElementsAre(testing::SizeIs(3)));
}

// A cut into a flat sheet does not open, and both its sides lie in one place.
TEST(Pattern, ASlitIsDrawnOnce) {
  Flattening flat;
  flat.uv = {{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {2, 0}};
  flat.source = {0, 1, 2, 3, 4, 5, 1};
  flat.cuts = {{1, 5}};
  flat.corner_uv = {{0, 1, 5}, {6, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 0, 5}};
  flat.triangle_chart = {0, 0, 0, 0, 0};
  flat.charts.resize(1);
  flat.charts[0].loops = {{0, 1, 5, 6, 2, 3, 4}};
  const Pattern pattern = Made(flat, {});
  EXPECT_THAT(LinesOf(pattern, LineKind::kSeam),
              ElementsAre(ElementsAre(Complex(2, 0), Complex(2, 2))));
  double length = 0;
  for (const Polyline& line : LinesOf(pattern, LineKind::kOutline)) length += Length(line, false);
  EXPECT_NEAR(length, 16, 1e-12);
}

TEST(Pattern, DigitsShowTheSmallestPiece) {
  EXPECT_EQ(DigitsFor(Made(CutSquare(), {10, 0, {}})), 3);
  EXPECT_EQ(DigitsFor(Made(CutSquare(), {0.1, 0, {}})), 5);
  EXPECT_EQ(DigitsFor(Made(CutSquare(), {1e-9, 0, {}})), 9);
  EXPECT_EQ(DigitsFor({}), 3);
}

TEST(Pattern, PiecesThatTheAllowanceBringsTogetherAreSetApart) {
  const Pattern apart = Made(CutSquare(), {1, 1, {}});
  EXPECT_EQ(apart.points, CutSquare().uv);
  const Pattern close = Made(CutSquare(5), {1, 1, {}});
  const std::vector<Polyline> allowance = LinesOf(close, LineKind::kAllowance);
  ASSERT_EQ(allowance.size(), 2u);
  std::array<Bounds, 2> boxes;
  for (std::size_t i = 0; i < 2; ++i) boxes[i].Add(allowance[i]);
  EXPECT_TRUE(boxes[0].max_x < boxes[1].min_x || boxes[1].max_y < boxes[0].min_y);
  // Moved, not bent: the piece with its lines is where its allowance is.
  EXPECT_NEAR(std::abs(close.points[5] - close.points[4]), std::hypot(4, 4), 1e-12);
  Polyline moved = LinesOf(close, LineKind::kSeam)[1];
  moved.insert(moved.end(), {close.points[4], close.points[5], close.points[3]});
  for (const Complex p : moved) {
    EXPECT_GT(p.real(), boxes[1].min_x);
    EXPECT_LT(p.real(), boxes[1].max_x);
    EXPECT_GT(p.imag(), boxes[1].min_y);
    EXPECT_LT(p.imag(), boxes[1].max_y);
  }
  EXPECT_NEAR(close.pieces[1].box.min_x, close.points[3].real(), 1e-12);
}

// The outline of a layout that is folded over and over, or of a server that lies.
TEST(Pattern, TheAllowanceOfAScribbleIsRefusedBeforeTheWork) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 500);
  Flattening flat = CutSquare();
  for (int i = 0; i < 5000; ++i) {
    flat.charts[0].loops[0].push_back(static_cast<std::uint32_t>(flat.uv.size()));
    flat.uv.emplace_back(place(random), place(random));
    flat.source.push_back(0);
  }
  const Result<Pattern> refused = MakePattern(flat, {1, 10, {}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(refused.error().field, "allowance");
  EXPECT_TRUE(MakePattern(flat, {1, 0, {}}));
}

// The second piece is a C with a gap of 1 mm.
TEST(Pattern, AnAllowanceThatClosesAGapIsToldOf) {
  Flattening flat = CutSquare(100);
  flat.charts[1].loops = {{}};
  for (const Complex p : std::vector<Complex>{{200, 0},
                                              {260, 0},
                                              {260, 29},
                                              {240, 29},
                                              {240, 20},
                                              {220, 20},
                                              {220, 40},
                                              {240, 40},
                                              {240, 30},
                                              {260, 30},
                                              {260, 60},
                                              {200, 60}}) {
    flat.charts[1].loops[0].push_back(static_cast<std::uint32_t>(flat.uv.size()));
    flat.uv.push_back(p);
    flat.source.push_back(0);
  }
  const Pattern pattern = Made(flat, {1, 3, {}});
  ASSERT_EQ(pattern.warnings.size(), 1u);
  EXPECT_EQ(pattern.warnings[0].kind, "allowance_lost");
  EXPECT_THAT(pattern.warnings[0].elements, ElementsAre(1));
  EXPECT_THAT(pattern.warnings[0].message,
              HasSubstr("piece 2 runs into the piece or closes a gap"));
  EXPECT_TRUE(Made(flat, {1, 0.4, {}}).warnings.empty());
}

TEST(Dxf, UnitLayersAndLengthsReadBack) {
  const std::vector<GrainLine> grain{{0, 1, 0}};
  const Pattern pattern = Made(CutSquare(), {10, 5, grain});
  const DxfFile file = ReadDxf(FormatDxf(pattern));
  EXPECT_EQ(file.header.at("$INSUNITS"), "4");
  EXPECT_EQ(file.header.at("$MEASUREMENT"), "1");
  EXPECT_THAT(file.layers, ElementsAre("0", "OUTLINE", "SEAM", "CUT", "GRAIN", "NOTCH", "LABEL"));
  std::map<std::string, std::vector<DxfEntity>> by_layer;
  for (const DxfEntity& entity : file.entities) by_layer[entity.layer].push_back(entity);
  const double diagonal = std::hypot(40, 40);
  ASSERT_EQ(by_layer["OUTLINE"].size(), 2u);
  ASSERT_EQ(by_layer["SEAM"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const DxfEntity &outline = by_layer["OUTLINE"][i], &seam = by_layer["SEAM"][i];
    EXPECT_FALSE(outline.closed || seam.closed);
    EXPECT_NEAR(Length(outline.points, false), 80, 1e-5);
    EXPECT_NEAR(Length(seam.points, false), diagonal, 1e-5);
    EXPECT_NEAR(Area(outline.points), 800, 1e-3);  // counter-clockwise, not mirrored
  }
  ASSERT_EQ(by_layer["GRAIN"].size(), 1u);
  EXPECT_EQ(by_layer["GRAIN"][0].type, "LINE");
  EXPECT_NEAR(Length(by_layer["GRAIN"][0].points, false), 40, 1e-5);
  ASSERT_EQ(by_layer["CUT"].size(), 2u);
  for (const DxfEntity& cut : by_layer["CUT"]) {
    EXPECT_TRUE(cut.closed);
    EXPECT_GT(Area(cut.points), 800 + 5 * (80 + diagonal));
  }
}

// A vertex that all pieces meet in has a copy on each; the grain line is on the one with both ends.
TEST(Pattern, GrainLinesOfManyCopiesAreFound) {
  constexpr std::uint32_t kPieces = 3000;
  Flattening flat;
  std::vector<GrainLine> grain;
  for (std::uint32_t i = 0; i < kPieces; ++i) {
    const double x = 10.0 * i;
    const std::uint32_t u = 3 * i;
    flat.uv.insert(flat.uv.end(), {{x, 0}, {x + 4, 0}, {x, 4}});
    flat.source.insert(flat.source.end(), {0, 1 + 2 * i, 2 + 2 * i});
    flat.corner_uv.push_back({u, u + 1, u + 2});
    flat.triangle_chart.push_back(i);
    flat.charts.emplace_back().loops = {{u, u + 1, u + 2}};
    grain.push_back({0, 2 + 2 * i, 0});
  }
  const Pattern pattern = Made(flat, {1, 0, grain});
  const std::vector<Polyline> lines = LinesOf(pattern, LineKind::kGrain);
  ASSERT_EQ(lines.size(), kPieces);
  EXPECT_THAT(lines[1234], ElementsAre(Complex(12340, 0), Complex(12340, 4)));
}

// Those of welded vertices run between the ones that stand for them.
TEST(Pattern, GrainLinesMayNameWeldedVertices) {
  Flattening flat = CutSquare();
  flat.welded = {0, 1, 2, 3, 0, 1};
  const std::vector<GrainLine> grain{{4, 5, 0}};
  EXPECT_THAT(LinesOf(Made(flat, {1, 0, grain}), LineKind::kGrain),
              ElementsAre(ElementsAre(Complex(0, 0), Complex(4, 0))));
}

TEST(PatternSheet, IsInMillimetres) {
  const Pattern pattern = Made(CutSquare(), {10, 0, {}});
  const std::string svg = FormatPattern(pattern, {/*strain=*/false, /*interior=*/false, {}});
  // 140 mm wide, 40 high, 10 round about.
  EXPECT_THAT(svg, HasSubstr("width=\"160mm\" height=\"60mm\" viewBox=\"0 0 160 60\""));
  const auto outlines = Paths(svg, "outline");
  ASSERT_EQ(outlines.size(), 2u);
  for (const auto& [line, closed] : outlines) {
    EXPECT_FALSE(closed);
    EXPECT_NEAR(Length(line, false), 80, 0.01);
    EXPECT_NEAR(Area(line), -800, 0.1);  // y goes down
  }
  EXPECT_EQ(Paths(svg, "seam").size(), 2u);
  // A cutter would cut along anything else.
  for (const char* absent :
       {"id=\"strain", "id=\"interior", "id=\"grain", "id=\"allowance", "<rect", "<text"}) {
    EXPECT_THAT(svg, Not(HasSubstr(absent)));
  }
}

// 0.4 mm: thousandths would bend its sides, and lines of usual width would cover it.
TEST(PatternSheet, SmallPiecesKeepTheirShape) {
  const Pattern pattern = Made(CutSquare(), {0.1, 0, {}});
  const auto outlines = Paths(FormatPattern(pattern, {false, false, {}}), "outline");
  ASSERT_EQ(outlines.size(), 2u);
  EXPECT_NEAR(Length(outlines[0].first, false), 0.8, 1e-4);
  EXPECT_THAT(FormatPattern(pattern, {true, false, {}}), HasSubstr("stroke-width=\"0.014\""));
}

TEST(PatternSheet, HasWhatIsAskedFor) {
  Flattening whole = CutSquare();
  whole.corner_uv = {{0, 1, 2}, {0, 2, 3}};  // an edge inside, and a chart for all
  whole.triangle_chart = {0, 0};
  whole.uv[3] = {0, 4};
  whole.charts.resize(1);
  whole.charts[0].loops = {{0, 1, 2, 3}};
  const std::vector<GrainLine> grain{{0, 1, 0}};
  const Pattern pattern = Made(whole, {1, 2, grain});
  const std::string svg = FormatPattern(pattern, {/*strain=*/true, /*interior=*/true, {"a < b"}});
  EXPECT_EQ(Paths(svg, "strain").size(), 2u);  // two shades
  EXPECT_EQ(Paths(svg, "interior").size(), 1u);
  EXPECT_EQ(Paths(svg, "grain").size(), 2u);  // the line and its head
  const auto allowance = Paths(svg, "allowance");
  ASSERT_EQ(allowance.size(), 1u);
  EXPECT_NEAR(std::abs(Area(allowance[0].first)), 64, 1e-6);
  EXPECT_THAT(svg, HasSubstr("+5 %"));
  EXPECT_THAT(svg, HasSubstr("larger principal strain"));
  EXPECT_THAT(svg, HasSubstr("50 mm"));
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
}

// A vertex of no triangle lies anywhere and must not widen the page.
TEST(PatternSheet, LooseVerticesAreNotDrawn) {
  Flattening flat = CutSquare();
  flat.uv.emplace_back(1e6, 1e6);
  flat.source.push_back(4);
  const std::string svg = FormatPattern(Made(flat, {10, 0, {}}), {false, false, {}});
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 160 60\""));
}

}  // namespace
}  // namespace arap
