// --weld, --stitch and --drop-duplicates on files as other programs write them.
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/commands/commands.h"
#include "tests/cli/run.h"

namespace arap::cli::mended {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Text of an OBJ file, grid by grid.
class ObjText {
 public:
  using Place = std::function<std::string(double x, double y)>;

  // nx × ny squares over [x0, x1] × [0, height].
  void AddGrid(int nx, int ny, double x0, double x1, double height, const Place& place) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        text_ += "v " + place(x0 + (x1 - x0) * i / nx, height * j / ny) + "\n";
      }
    }
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const int v = vertices_ + (nx + 1) * j + i + 1;
        text_ += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", v, v + 1, v + nx + 2, v + nx + 1);
      }
    }
    vertices_ += (nx + 1) * (ny + 1);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int vertices_ = 0;
};

std::string Flat(double x, double y) { return fmt::format("{} {} 0", x, y); }
// On a tube of radius 20; x in degrees.
std::string Round(double x, double y) {
  const double angle = x * 0.017453292519943295;
  return fmt::format("{:.6f} {:.6f} {}", 20 * std::cos(angle), 20 * std::sin(angle), y);
}

class RepairCommand : public FolderTest {
 protected:
  // The number of pieces; `more` are further words.
  std::size_t Pieces(const std::vector<std::string>& more, std::string* err) {
    std::vector<std::string> words{"flatten", "--spawn", "--report", Path("report.json")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = Arapctl(words);
    *err = outcome.err;
    if (outcome.code != 0) return 0;
    const auto report = nlohmann::json::parse(Slurp(Path("report.json")), nullptr, false);
    return report["charts"].size();
  }
};

TEST_F(RepairCommand, SurfacesAreWelded) {
  ObjText text;
  text.AddGrid(3, 3, 0, 45, 30, Round);
  text.AddGrid(3, 3, 45, 90, 30, Round);
  const std::string mesh = Put("halves.obj", text.text());
  std::string err;
  EXPECT_EQ(Pieces({mesh}, &err), 2u);
  EXPECT_THAT(err, HasSubstr("twin_vertices: 4 vertices of the border lie where others lie"));
  EXPECT_THAT(err, HasSubstr("weld joins it"));
  // The flag takes a number and nothing else for its value.
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--weld", mesh},
                                                {mesh, "--weld"},
                                                {"--weld", "1e-3", mesh},
                                                {mesh, "--weld=0.001"}}) {
    EXPECT_EQ(Pieces(words, &err), 1u) << err;
    EXPECT_THAT(err, HasSubstr("welded_vertices: 4 vertices were welded"));
    EXPECT_THAT(err, Not(HasSubstr("twin_vertices")));
  }
  EXPECT_EQ(Pieces({mesh, "--weld", "0"}, &err), 1u) << "equal places alone";
  EXPECT_EQ(Arapctl({"flatten", mesh, "--weld=near", "--spawn", "--report", Path("r")}).code, 2);
  EXPECT_EQ(Pieces({mesh, "--weld", "30"}, &err), 0u);
  EXPECT_THAT(err, HasSubstr("tolerance"));
}

TEST_F(RepairCommand, BordersAreStitchedAndDuplicatesDropped) {
  ObjText text;
  text.AddGrid(3, 2, 0, 45, 30, Round);
  text.AddGrid(3, 4, 45, 90, 30, Round);
  const std::string mesh = Put("t.obj", text.text() + "f 1 2 6\nf 2 1 6\n");
  std::string err;
  EXPECT_EQ(Pieces({mesh, "--weld"}, &err), 0u);
  EXPECT_THAT(err, HasSubstr("DUPLICATE_TRIANGLE"));
  EXPECT_THAT(err, HasSubstr("--drop-duplicates"));
  // The pieces share the ends of the longer edges only.
  EXPECT_EQ(Pieces({mesh, "--weld", "--drop-duplicates"}, &err), 0u);
  EXPECT_THAT(err, HasSubstr("2 T-junctions"));
  EXPECT_THAT(err, HasSubstr("stitch joins it"));
  EXPECT_EQ(Pieces({mesh, "--weld", "--drop-duplicates", "--stitch"}, &err), 1u);
  EXPECT_THAT(err, HasSubstr("dropped_triangles: 2 triangles"));
  EXPECT_THAT(err, HasSubstr("split_triangles"));
  EXPECT_THAT(err, Not(HasSubstr("t_junctions")));
}

// A polygon that is there once more as its triangles is a doubled one.
TEST_F(RepairCommand, AQuadAndItsTrianglesAreTold) {
  const std::string mesh = Put("sheet.obj",
                               "v 0 0\nv 8 0\nv 16 0\nv 0 6\nv 8 6\nv 16 6\n"
                               "f 1 2 5 4\nf 2 3 6 5\nf 1 2 5\nf 1 5 4\n");
  const Outcome told = Arapctl({"flatten", mesh, "--spawn", "--out", Path("flat.obj")});
  EXPECT_EQ(told.code, 3);
  EXPECT_THAT(told.err, HasSubstr("DUPLICATE_TRIANGLE: " + mesh +
                                  ":7: Triangles at lines 7 and 9 have the same vertices (2 such"));
  EXPECT_THAT(told.err, HasSubstr("--drop-duplicates"));
  const Outcome dropped =
      Arapctl({"flatten", mesh, "--drop-duplicates", "--spawn", "--out", Path("flat.obj")});
  EXPECT_EQ(dropped.code, 0);
  EXPECT_THAT(dropped.err, HasSubstr("dropped_triangles: 2 triangles"));
  EXPECT_THAT(dropped.err, HasSubstr("(lines 9 10)"));
  EXPECT_THAT(dropped.out, HasSubstr("\npiece 1: 16.000 × 6.000 mm\n"));
  EXPECT_THAT(Slurp(Path("flat.obj")), HasSubstr("\nf 1/1 2/2 5/5 4/4\nf 2/2 3/3 6/6 5/5\n"));
}

TEST_F(RepairCommand, PuppetsBendAsOne) {
  ObjText whole, halves;
  whole.AddGrid(10, 2, 0, 100, 20, Flat);
  halves.AddGrid(5, 2, 0, 50, 20, Flat);
  halves.AddGrid(5, 2, 50, 100, 20, Flat);
  const std::string track = Put("t.json", R"({"handles": [{"name": "left", "rest": [0, 10]},
                                    {"name": "right", "rest": [100, 10]}],
                        "frames": [{"targets": [[0, 10], [80, 60]]}]})");
  const auto bake = [&](const std::string& text, const std::vector<std::string>& more) {
    std::vector<std::string> words{
        "bake",  Put("bar.obj", text), track, "--spawn", "--basis", "face",
        "--out", Path("shapes.csv")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = Arapctl(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return ParseCsv(Slurp(Path("shapes.csv"))).rows.at(0);
  };
  const auto expected = bake(whole.text(), {}), shape = bake(halves.text(), {"--weld"});
  const auto torn = bake(halves.text(), {});
  ASSERT_EQ(shape.size(), 2u * 36);
  double apart = 0;
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t left = 2 * (6 * j + i) + k, right = left + 36;
        EXPECT_NEAR(shape[left], expected[2 * (11 * j + i) + k], 1e-6);
        EXPECT_NEAR(shape[right], expected[2 * (11 * j + 5 + i) + k], 1e-6);
        apart = std::max(apart, std::abs(torn[left] - expected[2 * (11 * j + i) + k]));
      }
    }
  }
  EXPECT_GT(apart, 1);
}

TEST(JoinedTest, OnlyANumberIsTheValueOfWeld) {
  EXPECT_THAT(Joined({"flatten", "--weld", "a.obj", "--weld", "1e-3", "--weld", "-1", "--weld"}),
              ElementsAre("flatten", "--weld", "a.obj", "--weld=1e-3", "--weld", "-1", "--weld"));
}

}  // namespace
}  // namespace arap::cli::mended
