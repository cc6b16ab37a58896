// flatten against a private server.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

class FlattenCommand : public FolderTest {
 protected:
  nlohmann::json Report() const {
    return nlohmann::json::parse(Slurp(Path("report.json")), nullptr, false);
  }

  // The vt lines u v u v….
  std::vector<double> FlatPositions() const {
    std::istringstream lines(Slurp(Path("flat.obj")));
    std::vector<double> uv;
    std::string word;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      double u = 0, v = 0;
      if (words >> word >> u >> v && word == "vt") uv.insert(uv.end(), {u, v});
    }
    return uv;
  }
};

TEST_F(FlattenCommand, LaysTheSampleGarmentFlat) {
  ASSERT_EQ(Arapctl({"sample", "garment", "--edge", "4", "--out", Path("skirt.obj")}).code, 0);
  const Outcome outcome =
      Arapctl({"flatten", Path("skirt.obj"), "--spawn", "--unit", "cm", "--out", Path("flat.obj"),
               "--svg", Path("layout.svg"), "--dxf", Path("layout.dxf"), "--allowance", "10",
               "--report", Path("report.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json report = Report();
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["distortion"]["flipped"], 0);
  EXPECT_EQ(report["charts"].size(), 1u);
  EXPECT_NEAR(report["distortion"]["area_ratio"].get<double>(), 1, 0.01);
  EXPECT_LT(report["distortion"]["max_stretch_percent"], 15);
  EXPECT_EQ(FlatPositions().size() / 2, report["vertices"].get<std::size_t>());
  EXPECT_THAT(Slurp(Path("layout.svg")), HasSubstr("larger principal strain"));
  EXPECT_THAT(Slurp(Path("layout.svg")), HasSubstr("id=\"allowance\""));
  EXPECT_THAT(Slurp(Path("layout.dxf")), HasSubstr("OUTLINE"));
  // The result is a mesh again.
  const auto mesh = ReadSurfaceMesh(Path("flat.obj"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), report["triangles"].get<std::size_t>());
}

TEST_F(FlattenCommand, AsAJobAnswersTheSame) {
  ASSERT_EQ(Arapctl({"sample", "garment", "--edge", "8", "--out", Path("skirt.obj")}).code, 0);
  const Outcome call =
      Arapctl({"flatten", Path("skirt.obj"), "--spawn", "--out", Path("flat.obj")});
  ASSERT_EQ(call.code, 0) << call.err;
  const Outcome job = Arapctl(
      {"flatten", Path("skirt.obj"), "--spawn", "--job", "skirts/one", "--out", Path("job.obj")});
  ASSERT_EQ(job.code, 0) << job.err;
  EXPECT_EQ(Slurp(Path("job.obj")), Slurp(Path("flat.obj")));
  EXPECT_EQ(job.out, call.out);
  const Outcome wrong =
      Arapctl({"flatten", Path("skirt.obj"), "--spawn", "--job", "one", "--out", Path("job.obj")});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("SESSION/JOB"));
}

constexpr std::size_t kColumns = 25, kRows = 9;

// A grid rolled up along its rows of straight rulings keeps the length of every edge, so its flat
// shape is the grid again, up to a motion of the plane.
SurfaceMesh RolledSheet() {
  constexpr double kStep = 0.25;  // radians between rulings
  const double radius = 0.5 / std::sin(kStep / 2);
  const PlanarMesh grid = MakeGrid(kColumns, kRows);
  SurfaceMesh rolled;
  rolled.triangles = grid.triangles;
  for (const Complex p : grid.vertices) {
    const double angle = kStep * p.real();
    rolled.vertices.push_back({radius * std::cos(angle), p.imag(), -radius * std::sin(angle)});
  }
  return rolled;
}

Complex At(const std::vector<double>& flat, std::size_t i) {
  return {flat[2 * i], flat[2 * i + 1]};
}

TEST_F(FlattenCommand, UnrollsARolledSheetWithEveryMethod) {
  const PlanarMesh grid = MakeGrid(kColumns, kRows);
  Put("rolled.obj", FormatObj(RolledSheet()));
  // The spectral anchors are exact to the end of their iteration only, so where no refinement
  // follows the others are asked for.
  const std::vector<std::vector<std::string>> methods{
      {},
      {"--basis", "edge", "--weights", "uniform", "--anchors", "center-edge", "--refine", "0"},
      {"--method", "arap-edge", "--basis", "edge-as-published", "--anchors", "center-edge",
       "--refine", "0"},
      {"--method", "arap-face", "--anchors", "spectral", "--refine-stop", "0"},
      {"--method", "arap-face", "--anchors", "far-boundary"},
      {"--method", "first-step", "--anchors", "center-edge"},
      {"--method", "lscm", "--anchors", "center-edge"},
      {"--method", "abf", "--anchors", "center-edge"},
      {"--injective"},
  };
  for (const auto& method : methods) {
    const std::string name = testing::PrintToString(method);
    std::vector<std::string> words{
        "flatten",        Path("rolled.obj"), "--spawn",          "--out",
        Path("flat.obj"), "--report",         Path("report.json")};
    words.insert(words.end(), method.begin(), method.end());
    const Outcome outcome = Arapctl(words);
    ASSERT_EQ(outcome.code, 0) << name << outcome.err;
    EXPECT_LT(Report()["distortion"]["max_stretch_percent"], 1e-6) << name;
    EXPECT_EQ(Report()["distortion"]["flipped"], 0) << name;
    const std::vector<double> uv = FlatPositions();
    ASSERT_EQ(uv.size(), 2 * grid.vertices.size());
    for (std::size_t v = 0; v < grid.vertices.size(); ++v) {
      for (const std::size_t to : {std::size_t{0}, kColumns - 1, grid.vertices.size() - 1}) {
        ASSERT_NEAR(std::abs(At(uv, v) - At(uv, to)),
                    std::abs(grid.vertices[v] - grid.vertices[to]), 1e-7)
            << name;
      }
    }
  }
}

TEST_F(FlattenCommand, DrawsAtTrueSizeAlongTheGrain) {
  Put("rolled.obj", FormatObj(RolledSheet()));
  // Along the first row, in centimetres: 24 wide and 8 high, 10 mm round about.
  const Outcome outcome =
      Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--unit", "cm", "--plain", "--grain",
               "1," + std::to_string(kColumns), "--svg", Path("a.svg"), "--dxf", Path("a.dxf")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(Slurp(Path("a.svg")),
              HasSubstr("width=\"260mm\" height=\"100mm\" viewBox=\"0 0 260 100\""));
  EXPECT_THAT(Slurp(Path("a.svg")), HasSubstr("id=\"grain\""));
  EXPECT_THAT(Slurp(Path("a.dxf")), HasSubstr("GRAIN"));
  const Outcome upright =
      Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--unit", "cm", "--plain", "--grain",
               "1," + std::to_string(kColumns) + ",90", "--svg", Path("b.svg")});
  ASSERT_EQ(upright.code, 0) << upright.err;
  EXPECT_THAT(Slurp(Path("b.svg")), HasSubstr("width=\"100mm\" height=\"260mm\""));
}

TEST_F(FlattenCommand, SaysHowLargeItIs) {
  Put("rolled.obj", FormatObj(RolledSheet()));
  const auto flatten = [&](const char* unit) {
    return Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--unit", unit, "--report",
                    Path("report.json")});
  };
  // On its smallest rectangle, the longer side along u.
  const Outcome millimetres = flatten("mm");
  ASSERT_EQ(millimetres.code, 0) << millimetres.err;
  EXPECT_THAT(millimetres.out, HasSubstr("piece 1: 24.000 × 8.000 mm\nsheet: 24.000 × 8.000 mm"));
  EXPECT_THAT(millimetres.err, testing::Not(HasSubstr("--unit")));
  EXPECT_NEAR(Report()["charts"][0]["size_mm"][0].get<double>(), 24, 1e-6);
  EXPECT_NEAR(Report()["sheet_mm"][1].get<double>(), 8, 1e-6);
  const Outcome metres = flatten("m");
  ASSERT_EQ(metres.code, 0) << metres.err;
  EXPECT_THAT(metres.err, HasSubstr("Piece 1 is 24000.000 × 8000.000 mm; --unit says"));
  EXPECT_EQ(Report()["warnings"][0]["kind"], "unlikely_size");
}

TEST_F(FlattenCommand, DrawsOnPagesAndRolls) {
  Put("rolled.obj", FormatObj(RolledSheet()));
  // 240 × 80 mm, on two pages that are upright or one on its side.
  const Outcome pages = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--unit", "cm",
                                 "--paper", "A4", "--pdf", Path("a.pdf"), "--svg", Path("a.svg")});
  ASSERT_EQ(pages.code, 0) << pages.err;
  EXPECT_TRUE(Slurp(Path("a.pdf")).starts_with("%PDF"));
  EXPECT_THAT(Slurp(Path("a-cover.svg")), HasSubstr("Sheet of 240.0 × 80.0 mm"));
  EXPECT_THAT(Slurp(Path("a-1.svg")), HasSubstr("width=\"297mm\" height=\"210mm\""));
  // Along the roll or across it.
  for (const auto& [width, size] :
       {std::pair("100", "240.000 × 80.000 mm"), std::pair("300", "80.000 × 240.000 mm")}) {
    const Outcome roll = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--unit", "cm",
                                  "--sheet-width", width, "--dxf", Path("a.dxf")});
    ASSERT_EQ(roll.code, 0) << roll.err;
    EXPECT_THAT(roll.out, HasSubstr(std::string("sheet: ") + size));
  }
  const Outcome narrow = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--unit", "cm",
                                  "--sheet-width", "70", "--dxf", Path("b.dxf")});
  EXPECT_EQ(narrow.code, 3);
  EXPECT_THAT(narrow.err, HasSubstr("Piece 1 needs 80.0 mm across the roll"));
  const Outcome unknown =
      Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--paper", "A9", "--pdf", Path("b.pdf")});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("A0 to A5, letter"));
}

TEST_F(FlattenCommand, HoldsPins) {
  Put("rolled.obj", FormatObj(RolledSheet()));
  Put("pins.txt", "1 5 6\n" + std::to_string(kColumns) + " 5 30\n");
  const Outcome outcome = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--pins",
                                   Path("pins.txt"), "--out", Path("flat.obj")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<double> uv = FlatPositions();
  ASSERT_EQ(uv.size(), 2 * kColumns * kRows);
  EXPECT_NEAR(uv[0], 5, 1e-9);
  EXPECT_NEAR(uv[1], 6, 1e-9);
  EXPECT_NEAR(uv[2 * kColumns - 2], 5, 1e-9);
  EXPECT_NEAR(uv[2 * kColumns - 1], 30, 1e-9);
  EXPECT_NEAR(uv[2 * kColumns], 4, 1e-6);  // the next row, on the left of the first
}

// Where the surface is more rigid it is strained less, triangle by triangle.
TEST_F(FlattenCommand, RigidTrianglesAreStrainedLess) {
  ASSERT_EQ(Arapctl({"sample", "face", "--edge", "2", "--out", Path("face.obj")}).code, 0);
  const auto strain = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"flatten",  Path("face.obj"),    "--spawn",
                                   "--report", Path("report.json"), "--sigma"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = Arapctl(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::vector<double> strains;
    const auto report = Report();
    for (const auto& s : report["singular_values"]) {
      strains.push_back(std::hypot(s[0].get<double>() - 1, s[1].get<double>() - 1));
    }
    EXPECT_EQ(strains.size(), report["triangles"].get<std::size_t>());
    return strains;
  };
  const std::vector<double> even = strain({});
  ASSERT_FALSE(even.empty());
  // The half that is strained most.
  std::vector<double> sorted = even;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                   sorted.end());
  const double middle = sorted[sorted.size() / 2];
  std::string lines;
  for (const double s : even) lines += s > middle ? "100\n" : "1\n";
  Put("rigidity.txt", lines);
  const std::vector<double> held = strain({"--rigidity", Path("rigidity.txt")});
  ASSERT_EQ(held.size(), even.size());
  double before = 0, after = 0;
  for (std::size_t t = 0; t < even.size(); ++t) {
    if (even[t] <= middle) continue;
    before += even[t];
    after += held[t];
  }
  EXPECT_LT(after, 0.8 * before);
}

TEST_F(FlattenCommand, SigmaNeedsAReport) {
  const Outcome outcome =
      Arapctl({"flatten", Path("a.obj"), "--out", Path("b.obj"), "--sigma", "--spawn"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("--report"));
}

TEST_F(FlattenCommand, FilesThatAreWrongAreNamedWithTheirLine) {
  Put("rolled.obj", FormatObj(RolledSheet()));
  Put("pins.txt", "1 0 0\n226 1 0\n");
  const Outcome pins = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--pins",
                                Path("pins.txt"), "--out", Path("flat.obj")});
  EXPECT_EQ(pins.code, 3);
  EXPECT_THAT(pins.err,
              HasSubstr("--pins " + Path("pins.txt") + ":2: vertex 226: the surface has 225"));
  Put("seams.txt", "1 2 3\n4\n");
  const Outcome seams = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--seams",
                                 Path("seams.txt"), "--out", Path("flat.obj")});
  EXPECT_EQ(seams.code, 3);
  EXPECT_THAT(seams.err, HasSubstr("--seams " + Path("seams.txt") + ":2: a seam goes from"));
  Put("rigidity.txt", "1\n1\n0\n");
  const Outcome rigidity = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--rigidity",
                                    Path("rigidity.txt"), "--out", Path("flat.obj")});
  EXPECT_EQ(rigidity.code, 3);
  EXPECT_THAT(rigidity.err, HasSubstr("rigidity.txt:3: a rigidity of 0 is not above 0"));
  const Outcome missing = Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--seams",
                                   Path("none.txt"), "--out", Path("flat.obj")});
  EXPECT_EQ(missing.code, 4);
  EXPECT_THAT(missing.err, HasSubstr("--seams " + Path("none.txt")));
}

// What the server finds is told as the files have it, and not as it counts.
TEST_F(FlattenCommand, FaultsOfTheServerAreInTheNumbersOfTheFiles) {
  const std::string mesh = Put("rolled.obj", FormatObj(RolledSheet()));
  const std::string in = Path("in");
  const auto fault = [&](const std::string& flag, const std::string& text) {
    Put("in", text);
    const Outcome outcome =
        Arapctl({"flatten", mesh, "--spawn", flag, in, "--out", Path("flat.obj")});
    EXPECT_EQ(outcome.code, 3) << text;
    return outcome.err;
  };
  EXPECT_THAT(fault("--seams", "1 2\r\n\r\n3 5\r\n"),
              HasSubstr("UNKNOWN_EDGE: --seams " + in +
                        ":3: A seam runs from vertex 3 to vertex 5, "
                        "which is no edge of the mesh. ("));
  EXPECT_THAT(fault("--seams", "[[0, 1],\n [2, 4]]"),
              HasSubstr("--seams " + in + ":2:2: A seam runs from vertex 2 to vertex 4,"));
  EXPECT_THAT(fault("--pins",
                    "\xef\xbb\xbf"
                    "7 0 0\n7 1 1\n"),
              HasSubstr("INVALID_OPTION: --pins " + in + ":2: Vertex 7 is pinned twice. ("));
  EXPECT_THAT(fault("--pins", "7 1 1 1e-99\n"), HasSubstr("--pins " + in + ":1: weight is 1e-99"));
  // The second triangle, in line 6, has no area.
  Put("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
  const Outcome surface =
      Arapctl({"flatten", Path("flat.obj"), "--spawn", "--out", Path("out.obj")});
  EXPECT_EQ(surface.code, 3);
  EXPECT_THAT(surface.err, HasSubstr("DEGENERATE_TRIANGLE: " + Path("flat.obj") +
                                     ":6: Triangle at line 6 is degenerate"));
  EXPECT_THAT(surface.err, HasSubstr("--tolerate-degenerate lets them through"));
}

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

TEST_F(FlattenCommand, RefusesWhatIsNoDisk) {
  Put("tetrahedron.obj", kTetrahedron);
  const Outcome outcome =
      Arapctl({"flatten", Path("tetrahedron.obj"), "--spawn", "--out", Path("flat.obj")});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("NOT_A_DISK"));
}

// Cut along the three edges at one corner a tetrahedron unfolds without strain.
TEST_F(FlattenCommand, CutsAlongSeams) {
  Put("tetrahedron.obj", kTetrahedron);
  Put("seams.txt", "1 4 2\n4 3 # all meet at the top\n");
  const Outcome outcome =
      Arapctl({"flatten", Path("tetrahedron.obj"), "--spawn", "--seams", Path("seams.txt"), "--out",
               Path("flat.obj"), "--report", Path("report.json"), "--svg", Path("net.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(FlatPositions().size(), 12u);  // the top three times
  EXPECT_LT(Report()["distortion"]["max_stretch_percent"], 1e-6);
  EXPECT_EQ(Report()["cut_edges"].size(), 3u);
  EXPECT_EQ(Report()["auto_cut_count"], 0);
  EXPECT_THAT(Slurp(Path("net.svg")), HasSubstr("id=\"seam\""));
}

TEST_F(FlattenCommand, AnAutomaticCutCanBeAskedForAgain) {
  Put("tetrahedron.obj", kTetrahedron);
  const Outcome outcome = Arapctl({"flatten", Path("tetrahedron.obj"), "--spawn", "--auto-cut",
                                   "--out", Path("flat.obj"), "--report", Path("report.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json first = Report();
  EXPECT_GT(first["auto_cut_count"], 0);
  const Outcome again = Arapctl({"flatten", Path("tetrahedron.obj"), "--spawn", "--seams",
                                 Path("report.json"), "--report", Path("report.json")});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(Report()["cut_edges"].size(), first["cut_edges"].size());
  EXPECT_EQ(Report()["auto_cut_count"], 0);
  EXPECT_NEAR(Report()["distortion"]["arap_energy"].get<double>(),
              first["distortion"]["arap_energy"].get<double>(), 1e-9);
}

TEST_F(FlattenCommand, ComparesMethods) {
  ASSERT_EQ(Arapctl({"sample", "face", "--edge", "2", "--out", Path("face.obj")}).code, 0);
  const Outcome outcome =
      Arapctl({"flatten", Path("face.obj"), "--spawn", "--compare", Path("compare.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string svg = Slurp(Path("compare.svg"));
  for (const char* label :
       {"First step, as published", "Second step, as published", "Face cells, refined",
        "Least squares conformal", "Angle-based", "Injective"}) {
    EXPECT_THAT(svg, HasSubstr(label));
    EXPECT_THAT(outcome.out, HasSubstr(label));
  }
  EXPECT_THAT(svg, testing::Not(HasSubstr("no layout")));
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
}

TEST_F(FlattenCommand, GivesUpInTime) {
  ASSERT_EQ(Arapctl({"sample", "face", "--edge", "0.2", "--out", Path("face.obj")}).code, 0);
  const Outcome outcome = Arapctl(
      {"flatten", Path("face.obj"), "--spawn", "--timeout", "0.001", "--out", Path("flat.obj")});
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.err, HasSubstr("DEADLINE_EXCEEDED"));
}

}  // namespace
}  // namespace arap::cli
