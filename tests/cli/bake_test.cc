// bake and drag against a private server.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

class Bake : public FolderTest {
 protected:
  void SetUp() override {
    const Outcome outcome = Arapctl({"sample", "character", "--edge", "8", "--out",
                                     Path("bear.obj"), "--track", Path("bear.json")});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }

  // Runs a command on the bear.
  Outcome OnBear(const std::string& command, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{command, Path("bear.obj"), Path("bear.json"), "--spawn"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Arapctl(arguments);
  }

  // Every row is finite and as long as the mesh, and the first is the rest shape.
  void ExpectShapes(const std::string& path, std::size_t rows) const {
    const auto mesh = ReadPlanarMesh(Path("bear.obj"));
    ASSERT_TRUE(mesh);
    const Csv csv = ParseCsv(Slurp(path));
    EXPECT_TRUE(csv.header.starts_with("frame,x0,y0,x1,y1,")) << csv.header.substr(0, 40);
    ASSERT_EQ(csv.rows.size(), rows);
    for (std::size_t i = 0; i < rows; ++i) {
      EXPECT_EQ(csv.frames[i], i);
      ASSERT_EQ(csv.rows[i].size(), 2 * mesh->vertices.size());
      for (const double x : csv.rows[i]) ASSERT_TRUE(std::isfinite(x)) << "frame " << i;
    }
    for (std::size_t k = 0; k < mesh->vertices.size(); ++k) {
      ASSERT_NEAR(csv.rows[0][2 * k], mesh->vertices[k].real(), 1e-6) << "vertex " << k;
      ASSERT_NEAR(csv.rows[0][2 * k + 1], mesh->vertices[k].imag(), 1e-6) << "vertex " << k;
    }
  }
};

TEST_F(Bake, WritesAShapePerFrame) {
  const Outcome outcome = OnBear(
      "bake", {"--out", Path("shapes.csv"), "--svg", Path("a.svg"), "--frames-svg", Path("b.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("120 frames"));
  EXPECT_THAT(outcome.out, HasSubstr("; 0 frames with flips"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("frame 1/")));  // progress is for terminals
  ExpectShapes(Path("shapes.csv"), 120);
  EXPECT_THAT(Slurp(Path("a.svg")), HasSubstr("repeatCount=\"indefinite\""));
  EXPECT_THAT(Slurp(Path("b.svg")), HasSubstr("frame 119"));
}

TEST_F(Bake, SaysWhatWasNotMeasured) {
  ASSERT_EQ(OnBear("bake", {"--out", Path("all.csv")}).code, 0);
  const Outcome some =
      OnBear("bake", {"--out", Path("some.csv"), "--measure-every", "50", "--json"});
  ASSERT_EQ(some.code, 0) << some.err;
  EXPECT_THAT(some.out, HasSubstr("\"frames_measured\": 3"));
  EXPECT_THAT(some.out, HasSubstr("\"frames_with_flips\": 0"));
  const Outcome none =
      OnBear("bake", {"--out", Path("none.csv"), "--measure-every", "0", "--json"});
  ASSERT_EQ(none.code, 0) << none.err;
  EXPECT_THAT(none.out, HasSubstr("\"frames_measured\": 0"));
  EXPECT_THAT(none.out, HasSubstr("\"frames_with_flips\": null"));
  EXPECT_THAT(none.out, HasSubstr("\"max_stretch\": null"));
  const Outcome text = OnBear("bake", {"--out", Path("none.csv"), "--measure-every", "0"});
  EXPECT_THAT(text.out, HasSubstr("; flips not measured; largest stretch not measured"));
  EXPECT_EQ(Slurp(Path("some.csv")), Slurp(Path("all.csv")));
  EXPECT_EQ(Slurp(Path("none.csv")), Slurp(Path("all.csv")));
  EXPECT_EQ(OnBear("bake", {"--out", Path("none.csv"), "--measure-every", "-1"}).code, 2);
}

TEST_F(Bake, EveryBasisModeAndHandleKind) {
  const std::vector<std::vector<std::string>> choices{
      {"--basis", "face", "--refine", "2"},
      {"--basis", "vertex", "--weights", "cotangent"},
      {"--as-published"},
      {"--hard"},
      {"--mode", "similarity"},
      {"--mode", "baseline"}};
  for (std::vector<std::string> choice : choices) {
    choice.insert(choice.end(), {"--out", Path("shapes.csv")});
    const Outcome outcome = OnBear("bake", choice);
    ASSERT_EQ(outcome.code, 0) << testing::PrintToString(choice) << outcome.err;
    ExpectShapes(Path("shapes.csv"), 120);
  }
}

TEST_F(Bake, TwoRunsGiveTheSameBytes) {
  ASSERT_EQ(OnBear("bake", {"--out", Path("a.csv")}).code, 0);
  ASSERT_EQ(OnBear("bake", {"--out", Path("b.csv")}).code, 0);
  EXPECT_EQ(Slurp(Path("a.csv")), Slurp(Path("b.csv")));
}

TEST_F(Bake, AFullDiskIsAFailure) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const Outcome outcome = OnBear("bake", {"--out", "/dev/full"});
  EXPECT_EQ(outcome.code, 8);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write /dev/full"));
}

TEST_F(Bake, FaultsOfTheServerNameReasonAndElements) {
  const std::string mesh = Put("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
  const std::string track = Put("t.json", R"({"handles": [{"rest": [0.2, 0.2]}], "frames": []})");
  const Outcome outcome = Arapctl({"bake", mesh, track, "--spawn", "--out", Path("c.csv")});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err,
              HasSubstr("DEGENERATE_TRIANGLE: " + mesh + ":6: Triangle at line 6 is degenerate"));
  EXPECT_THAT(outcome.err, HasSubstr("(lines = 6;"));
  Put("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 1\nf 1 2 3\nf 1 2 4\n");
  const Outcome bent = Arapctl({"bake", mesh, track, "--spawn", "--out", Path("c.csv")});
  EXPECT_THAT(bent.err, HasSubstr(mesh + ": not in a plane: vertex "));
  EXPECT_THAT(bent.err, HasSubstr("(vertices = "));

  const std::string outside = Put("o.json",
                                  "{\"handles\": [{\"rest\": [0, 0]},\n"
                                  " {\"rest\": [9, 9]}], \"frames\": []}");
  const std::string good = Put("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome handle = Arapctl({"bake", good, outside, "--spawn", "--out", Path("c.csv")});
  EXPECT_EQ(handle.code, 3);
  EXPECT_THAT(handle.err, HasSubstr("HANDLE_OUTSIDE: " + outside + ":2:2: Handle \"h1\""));
}

// What a tracker writes that has lost a marker: the handle stays where it was.
TEST_F(Bake, LostMarkersKeepTheirLastTarget) {
  const std::string mesh = Put("bar.obj", FormatObj(MakeGrid(11, 3)));
  const auto track = [](const std::string& second, const std::string& last) {
    return R"({"handles": [{"name": "a", "rest": [0, 1]}, {"name": "b", "rest": [5, 1]},
                           {"name": "c", "rest": [10, 1]}],
               "frames": [{"targets": [[0, 1], [5, 1.5], [10, 2]]},
                          {"targets": [[0, 1], )" +
           second + ", [10, 3]" + R"(]}, {"targets": [[0, 1], [5, 2])" + last + "]}]}";
  };
  const std::string whole = Put("whole.json", track("[5, 1.5]", ", [10, 3]"));
  const std::string lost = Put("lost.json", track("null", ""));
  for (const std::string command : {"bake", "drag"}) {
    std::vector<std::string> words{command, mesh, whole, "--spawn", "--out", Path("whole.csv")};
    if (command == "drag") words.insert(words.end(), {"--delivery", "every"});
    ASSERT_EQ(Arapctl(words).code, 0);
    words[2] = lost;
    words[5] = Path("lost.csv");
    const Outcome outcome = Arapctl(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: kept_targets: " + lost +
                                       ": 2 targets are null or missing, the first that of handle "
                                       "\"b\" in frame 1"));
    EXPECT_EQ(Slurp(Path("lost.csv")), Slurp(Path("whole.csv"))) << command;
  }
}

TEST_F(Bake, APuppetMayLieInAnyPlane) {
  const auto bar = [](const char* vertex) {
    std::string text;
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 9; ++x) {
        text += fmt::format(fmt::runtime(vertex), 10 * x, 10 * y, (x * 7 + y * 5) % 11) + '\n';
      }
    }
    for (int y = 0; y < 2; ++y) {
      for (int x = 1; x < 9; ++x) {
        const int v = 9 * y + x;
        text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", v, v + 1, v + 10, v + 9);
      }
    }
    return text;
  };
  // Its handle on the end of the bar lies 8e-8 outside.
  const std::string track =
      Put("t.json",
          R"({"handles": [{"name": "a", "rest": [0, 10]}, {"name": "b", "rest": [80.00000008, 10]}],
                        "frames": [{"targets": [[0, 10], [60, 50]]}]})");
  const auto bake = [&](const char* vertex, const std::string& note) {
    const Outcome outcome = Arapctl(
        {"bake", Put("bar.obj", bar(vertex)), track, "--spawn", "--out", Path("shapes.csv")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    if (note.empty()) {
      EXPECT_EQ(outcome.err, "");
    } else {
      EXPECT_THAT(outcome.err, HasSubstr(note));
    }
    return Slurp(Path("shapes.csv"));
  };
  const std::string flat = bake("v {0} {1} 0", "");
  EXPECT_EQ(bake("v {0} 5 {1}", "plane of x and z"), flat);
  EXPECT_EQ(bake("v 5 {0} {1}", "plane of y and z"), flat);
  EXPECT_EQ(bake("v {0} {1} {2}e-8", "z differs by 1e-07"), flat);
}

TEST_F(Bake, DragEveryAnswersEveryUpdate) {
  const Outcome outcome =
      OnBear("drag", {"--delivery", "every", "--out", Path("shapes.csv"), "--json", Path("t.json"),
                      "--svg", Path("a.svg"), "--frames-svg", Path("b.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("120 updates, 120 answers, 0 replaced"));
  ExpectShapes(Path("shapes.csv"), 120);
  const auto json = nlohmann::json::parse(Slurp(Path("t.json")), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["answered"], 120);
  EXPECT_GT(json["round_trip_micros"]["p50"], 0);
  EXPECT_GE(json["round_trip_micros"]["p99"], json["round_trip_micros"]["p50"]);
}

TEST_F(Bake, DragEveryAndBakeAgree) {
  ASSERT_EQ(OnBear("bake", {"--out", Path("a.csv")}).code, 0);
  ASSERT_EQ(OnBear("drag", {"--delivery", "every", "--out", Path("b.csv")}).code, 0);
  // A track may take several frames at a time, which rounds otherwise.
  const Csv baked = ParseCsv(Slurp(Path("a.csv")));
  const Csv dragged = ParseCsv(Slurp(Path("b.csv")));
  ASSERT_EQ(baked.rows.size(), dragged.rows.size());
  for (std::size_t i = 0; i < baked.rows.size(); ++i) {
    ASSERT_EQ(baked.rows[i].size(), dragged.rows[i].size());
    for (std::size_t k = 0; k < baked.rows[i].size(); ++k) {
      ASSERT_NEAR(baked.rows[i][k], dragged.rows[i][k], 1e-9) << "frame " << i;
    }
  }
}

TEST_F(Bake, DragLatestAnswersOrReplacesEveryUpdate) {
  const Outcome outcome = OnBear("drag", {"--rate", "10000", "--json", Path("t.json")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(Slurp(Path("t.json")), nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["sent"], 120);
  EXPECT_GE(json["answered"], 1);
  EXPECT_EQ(json["answered"].get<int>() + json["replaced"].get<int>(), 120);
}

}  // namespace
}  // namespace arap::cli
