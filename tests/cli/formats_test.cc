// Meshes of every format through the real arapctl, against a private server.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/run.h"
#include "tests/support/mesh_bytes.h"

namespace arap::cli {
namespace {

using ::testing::HasSubstr;
namespace mesh_bytes = arap::testing;

class Formats : public FolderTest {
 protected:
  Outcome Flatten(const std::string& path) const {
    return Arapctl(
        {"flatten", path, "--spawn", "--out", Path("flat.obj"), "--report", Path("report.json")});
  }
};

// The lines of a text that begin with a word.
std::string LinesOf(const std::string& text, const std::string& word) {
  std::istringstream lines(text);
  std::string found;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(word + " ")) found += line + "\n";
  }
  return found;
}

TEST_F(Formats, LayOneSurfaceFlatInOneWay) {
  constexpr int kAcross = 6, kAlong = 3;
  constexpr double kBend = 20, kHigh = 10;
  const double width = kAcross * 2 * kBend * std::sin(std::numbers::pi / (4 * kAcross));
  std::string layout;
  for (const auto& [name, bytes] :
       mesh_bytes::InEveryFormat(mesh_bytes::QuarterTube(kAcross, kAlong, kBend, kHigh))) {
    SCOPED_TRACE(name);
    const Outcome outcome = Flatten(Put(name, bytes));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto report = nlohmann::json::parse(Slurp(Path("report.json")));
    auto sides = report["sheet_mm"].get<std::vector<double>>();
    std::sort(sides.begin(), sides.end());
    EXPECT_NEAR(sides[0], kAlong * kHigh, 1e-4);
    EXPECT_NEAR(sides[1], width, 1e-4);
    EXPECT_EQ(report["vertices"], (kAcross + 1) * (kAlong + 1));
    EXPECT_EQ(report["triangles"], 2 * kAcross * kAlong);
    const std::string text = Slurp(Path("flat.obj"));
    const bool stl = name.find(".stl") != std::string::npos;
    const std::string answer =
        LinesOf(text, "v") + LinesOf(text, "vt") + report["distortion"].dump();
    if (layout.empty()) layout = answer;
    // STL has the vertices in an order of its own.
    if (!stl) {
      EXPECT_EQ(answer, layout);
    }
    const bool obj = name.find(".obj") != std::string::npos;
    EXPECT_EQ(outcome.err.find("written_anew") == std::string::npos, obj) << outcome.err;
    EXPECT_EQ(outcome.err.find("joined_corners") != std::string::npos, stl) << outcome.err;
  }
}

TEST_F(Formats, SayWhatIsLostWhenTheyAreWrittenAnew) {
  const std::string colours =
      "COFF\n3 1 0\n0 0 0 255 0 0 255\n8 0 0 255 0 0 255\n8 6 0 255 0 0 255\n3 0 1 2\n";
  const Outcome outcome = Flatten(Put("colours.off", colours));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "arapctl: warning: written_anew: " + Path("flat.obj") +
                             " is written anew, with the vertices, faces and objects of " +
                             Path("colours.off") +
                             "; colours, normals and the like are not kept\n");
}

// Same bytes for the same puppet.
TEST_F(Formats, BendOnePuppetInOneWay) {
  const mesh_bytes::Polygons bar{{{0, 0, 0}, {4, 0, 0}, {8, 0, 0}, {0, 2, 0}, {4, 2, 0}, {8, 2, 0}},
                                 {{0, 1, 4, 3}, {1, 2, 5, 4}}};
  const std::string track =
      Put("track.json",
          R"({"handles":[{"name":"a","rest":[0,0]},{"name":"b","rest":[8,0]},{"name":"c",)"
          R"("rest":[4,2]}],"frames":[{"targets":[[0,0],[8,1],[3,3]]}]})");
  std::string shapes;
  for (const auto& [name, bytes] : mesh_bytes::InEveryFormat(bar)) {
    if (name.find(".stl") != std::string::npos) continue;
    SCOPED_TRACE(name);
    const Outcome outcome =
        Arapctl({"bake", Put(name, bytes), track, "--out", Path("shapes.csv"), "--spawn"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    if (shapes.empty()) shapes = Slurp(Path("shapes.csv"));
    EXPECT_EQ(Slurp(Path("shapes.csv")), shapes);
  }
}

TEST_F(Formats, WhatIsWrongHasAPlace) {
  std::string claim = mesh_bytes::StlBytesOf(mesh_bytes::QuarterTube(2, 1, 20, 10));
  claim.replace(80, 4, mesh_bytes::BytesOf(std::uint32_t{2000000000}));
  const Outcome outcome = Flatten(Put("claim.stl", claim));
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr(Path("claim.stl") + ": byte 80: the header claims 2000000000 "
                                                         "triangles, the file has room for 4"));
  // Of the server, in the numbers of the file: faces of a binary file have no lines.
  mesh_bytes::Polygons folded = mesh_bytes::QuarterTube(2, 1, 20, 10);
  folded.faces.push_back({0, 1, 0});
  for (const char* format : {"ascii", "binary_big_endian"}) {
    // Whatever it is called.
    for (const char* name : {"a.ply", "b.obj"}) {
      const std::string path = Put(name, mesh_bytes::PlyOf(folded, format));
      const Outcome repeated = Flatten(path);
      EXPECT_EQ(repeated.code, 3);
      const bool text = format == std::string("ascii");
      EXPECT_THAT(repeated.err, HasSubstr(path + (text ? ":19: Triangle at line 19 "
                                                       : ": face 2: Triangle of face 2 ")));
      EXPECT_THAT(repeated.err, HasSubstr("has the vertices 0, 1 and 0"));
    }
  }
}

}  // namespace
}  // namespace arap::cli
