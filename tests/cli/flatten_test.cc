// flatten against a private server.
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/mesh_file.h"
#include "client/cli/sample/grid.h"
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
      Arapctl({"flatten", Path("skirt.obj"), "--spawn", "--out", Path("flat.obj"), "--svg",
               Path("layout.svg"), "--report", Path("report.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json report = Report();
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["distortion"]["flipped"], 0);
  EXPECT_EQ(report["distortion"]["scale"], 1);
  EXPECT_NEAR(report["distortion"]["area_ratio"].get<double>(), 1, 0.01);
  EXPECT_LT(report["distortion"]["max_stretch_percent"], 15);
  EXPECT_EQ(FlatPositions().size() / 2, report["vertices"].get<std::size_t>());
  EXPECT_THAT(Slurp(Path("layout.svg")), HasSubstr("larger principal strain"));
  // The result is a mesh again.
  const auto mesh = ReadSurfaceMesh(Path("flat.obj"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangle_count(), report["triangles"].get<std::size_t>());
}

// A grid rolled up along its rows of straight rulings keeps the length of every edge, so its flat
// shape is the grid again, up to a motion of the plane.
TEST_F(FlattenCommand, UnrollsARolledSheet) {
  constexpr std::size_t kColumns = 25, kRows = 9;
  constexpr double kStep = 0.25;  // radians between rulings
  const double radius = 0.5 / std::sin(kStep / 2);
  client::PlanarMesh grid = MakeGrid(kColumns, kRows);
  client::SurfaceMesh rolled;
  rolled.triangles = grid.triangles;
  for (std::size_t v = 0; v < grid.vertex_count(); ++v) {
    const double angle = kStep * grid.vertices[2 * v];
    rolled.vertices.insert(
        rolled.vertices.end(),
        {radius * std::cos(angle), grid.vertices[2 * v + 1], -radius * std::sin(angle)});
  }
  Put("rolled.obj", FormatObj(rolled));
  for (const char* basis : {"edge", "edge-as-published", "face"}) {
    const Outcome outcome =
        Arapctl({"flatten", Path("rolled.obj"), "--spawn", "--out", Path("flat.obj"), "--basis",
                 basis, "--weights", "uniform", "--report", Path("report.json")});
    ASSERT_EQ(outcome.code, 0) << basis << outcome.err;
    EXPECT_LT(Report()["distortion"]["max_stretch_percent"], 1e-6) << basis;
    const std::vector<double> uv = FlatPositions();
    ASSERT_EQ(uv.size(), grid.vertices.size());
    const auto distance = [](const std::vector<double>& points, std::size_t a, std::size_t b) {
      return std::hypot(points[2 * a] - points[2 * b], points[2 * a + 1] - points[2 * b + 1]);
    };
    for (std::size_t v = 0; v < grid.vertex_count(); ++v) {
      for (const std::size_t to : {std::size_t{0}, kColumns - 1, grid.vertex_count() - 1}) {
        ASSERT_NEAR(distance(uv, v, to), distance(grid.vertices, v, to), 1e-7) << basis;
      }
    }
  }
}

TEST_F(FlattenCommand, RefusesWhatIsNoDisk) {
  Put("tetrahedron.obj",
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const Outcome outcome =
      Arapctl({"flatten", Path("tetrahedron.obj"), "--spawn", "--out", Path("flat.obj")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("NOT_A_DISK"));
}

}  // namespace
}  // namespace arap::cli
