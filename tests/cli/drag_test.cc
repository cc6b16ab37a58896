// Edits and picks: drag, and bake where it does the same, against a private server.
#include <span>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/track.h"
#include "tests/cli/run.h"

namespace arap::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kAgree = 1e-9;

class Drag : public FolderTest {
 protected:
  // 8 × 8 unit squares.
  void SetUp() override { Put("grid.obj", FormatObj(MakeGrid(9, 9))); }

  Outcome OnGrid(const std::string& command, const std::string& track,
                 const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{command, Path("grid.obj"), Put("track.json", track),
                                       "--spawn"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Arapctl(arguments);
  }

  nlohmann::json Json(const std::string& name) const {
    auto json = nlohmann::json::parse(Slurp(Path(name)), nullptr, false);
    EXPECT_TRUE(json.is_object()) << name;
    return json;
  }

  // The shapes of a track, baked.
  Csv Baked(const Track& track) const {
    const Outcome outcome = OnGrid("bake", FormatTrack(track), {"--out", Path("baked.csv")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return ParseCsv(Slurp(Path("baked.csv")));
  }
};

void ExpectRow(const std::vector<double>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t k = 0; k < actual.size(); ++k) {
    ASSERT_NEAR(actual[k], expected[k], kAgree) << "coordinate " << k;
  }
}

TrackHandle At(const char* name, double x, double y) {
  TrackHandle at;
  at.handle.id = name;
  at.handle.anchor = PointAnchor{{x, y}};
  at.rest = {x, y};
  return at;
}

// Left and right at first; a top joins them, then another handle takes the place of the left.
Track EditedTrack() {
  Track track;
  track.handles = {At("left", 0.5, 4), At("right", 7.5, 4)};
  const std::vector<std::vector<Complex>> frames{
      {{0.5, 4}, {7.5, 4}},       {{0.5, 4}, {7, 6}},         {{0.5, 4}, {7, 6}, {4, 8}},
      {{0, 4}, {7, 6}, {3, 8.5}}, {{7, 6}, {3, 8.5}, {5, 0}}, {{8, 5}, {3, 9}, {5, -1}}};
  for (const std::vector<Complex>& places : frames) {
    TrackFrame& frame = track.frames.emplace_back();
    for (const Complex place : places) frame.targets.push_back({.position = place});
  }
  track.edits = {{2, {}, {At("top", 4, 7.25)}}, {4, {"left"}, {At("bottom", 4, 0.25)}}};
  return track;
}

// A track without edits that has the handles and the frames of one segment.
Track Alone(const Track& track, std::size_t index) {
  TrackSegments segments(track);
  for (std::size_t i = 0; i < index; ++i) segments.Next();
  const TrackSegment& segment = segments.segment();
  std::vector<TrackHandle> all = track.handles;
  for (const TrackEdit& edit : track.edits) {
    all.insert(all.end(), edit.add.begin(), edit.add.end());
  }
  Track alone;
  for (const std::size_t number : segment.numbers) alone.handles.push_back(all[number]);
  const auto frames = std::span(track.frames).subspan(segment.first, segment.end - segment.first);
  alone.frames.assign(frames.begin(), frames.end());
  return alone;
}

// Both handles move by (10, 5), and the shape with them.
constexpr const char* kMoved = R"({
  "handles": [{"name": "a", "rest": [1, 1]}, {"name": "b", "rest": [7, 7]}],
  "frames": [{"targets": [[1, 1], [7, 7]]}, {"targets": [[11, 6], [17, 12]]}]})";

TEST_F(Drag, EditsGiveTheShapesOfFreshHandles) {
  const Track track = EditedTrack();
  const Outcome outcome =
      OnGrid("drag", FormatTrack(track),
             {"--delivery", "every", "--out", Path("a.csv"), "--json", Path("t.json"), "--svg",
              Path("a.svg"), "--frames-svg", Path("b.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("6 updates, 6 answers"),
                                 HasSubstr("edit before frame 2: 0 removed, 1 added in "),
                                 HasSubstr("edit before frame 4: 1 removed, 1 added in ")));
  const Csv dragged = ParseCsv(Slurp(Path("a.csv")));
  ASSERT_EQ(dragged.rows.size(), 6u);
  for (std::size_t s = 0; s < 3; ++s) {
    SCOPED_TRACE(fmt::format("segment {}", s));
    const Csv fresh = Baked(Alone(track, s));
    ASSERT_EQ(fresh.rows.size(), 2u);
    ExpectRow(dragged.rows[2 * s], fresh.rows[0]);
    ExpectRow(dragged.rows[2 * s + 1], fresh.rows[1]);
  }

  const auto edits = Json("t.json")["edits"];
  ASSERT_EQ(edits.size(), 2u);
  EXPECT_EQ(edits[1]["frame"], 4);
  EXPECT_EQ(edits[1]["removed"], 1);
  EXPECT_EQ(edits[1]["added"], 1);
  EXPECT_GT(edits[1]["solve_micros"], 0);
  EXPECT_GT(edits[1]["round_trip_micros"], edits[1]["solve_micros"]);
  EXPECT_THAT(Slurp(Path("a.svg")), AllOf(HasSubstr("attributeName=\"r\""), Not(HasSubstr("nan"))));
  EXPECT_THAT(Slurp(Path("b.svg")), Not(HasSubstr("nan")));
}

TEST_F(Drag, BakeEditsBetweenItsFrames) {
  const std::string track = FormatTrack(EditedTrack());
  ASSERT_EQ(OnGrid("drag", track, {"--delivery", "every", "--out", Path("a.csv")}).code, 0);
  const Outcome outcome = OnGrid("bake", track, {"--out", Path("b.csv"), "--svg", Path("a.svg")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("6 frames"),
                                 HasSubstr("edit before frame 4: 1 removed, 1 added in ")));
  const Csv dragged = ParseCsv(Slurp(Path("a.csv")));
  const Csv baked = ParseCsv(Slurp(Path("b.csv")));
  ASSERT_EQ(baked.rows.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(baked.frames[i], i);
    ExpectRow(baked.rows[i], dragged.rows[i]);
  }
}

TEST_F(Drag, SaysWhatWasNotMeasured) {
  const std::string track = FormatTrack(EditedTrack());
  std::string shapes;
  for (const auto& [every, measured] : {std::pair("1", 6), std::pair("2", 3), std::pair("0", 0)}) {
    const Outcome outcome = OnGrid("drag", track,
                                   {"--delivery", "every", "--out", Path("a.csv"), "--json",
                                    Path("t.json"), "--measure-every", every});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto json = Json("t.json");
    EXPECT_EQ(json["frames_measured"], measured) << every;
    EXPECT_EQ(json["frames_with_flips"].is_null(), measured == 0);
    EXPECT_EQ(json["most_flips"].is_null(), measured == 0);
    EXPECT_GT(json["worst_handle_error"], 0);
    EXPECT_EQ(outcome.out.find("flips not measured") != std::string::npos, measured == 0);
    if (shapes.empty()) shapes = Slurp(Path("a.csv"));
    EXPECT_EQ(Slurp(Path("a.csv")), shapes);
  }
}

TEST_F(Drag, LatestEditsToo) {
  const Outcome outcome = OnGrid("drag", FormatTrack(EditedTrack()),
                                 {"--rate", "100000", "--json", Path("t.json"), "--pick", "5,-1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = Json("t.json");
  EXPECT_EQ(json["answered"].get<int>() + json["replaced"].get<int>(), 6);
  ASSERT_EQ(json["edits"].size(), 2u);
  EXPECT_EQ(json["edits"][0]["frame"], 2);
  // The last frame holds the new handle here.
  ASSERT_EQ(json["picks"].size(), 1u);
  ASSERT_TRUE(json["picks"][0]["hit"]);
  EXPECT_NEAR(json["picks"][0]["rest"][0], 4, 1e-3);
  EXPECT_NEAR(json["picks"][0]["rest"][1], 0.25, 1e-3);
}

TEST_F(Drag, HardHoldsForAddedHandlesToo) {
  Track track = EditedTrack();
  const auto worst = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--delivery", "every", "--json", Path("t.json")});
    const Outcome outcome = OnGrid("drag", FormatTrack(track), more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Json("t.json")["worst_handle_error"].get<double>();
  };
  EXPECT_GT(worst({}), 1e-9);
  EXPECT_LT(worst({"--hard"}), 1e-9);
}

TEST_F(Drag, AnEditThatFailsIsNamed) {
  Track track = EditedTrack();
  track.edits[1].add[0] = At("far", 99, 0);
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands{
      {"drag", {"--delivery", "every"}},
      {"drag", {"--rate", "100000"}},
      {"bake", {"--out", Path("a.csv")}}};
  for (const auto& [command, more] : commands) {
    const Outcome outcome = OnGrid(command, FormatTrack(track), more);
    EXPECT_EQ(outcome.code, 3) << command;
    // The track is one line.
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("HANDLE_OUTSIDE: "), HasSubstr(".json:1:"),
                                   HasSubstr(": edit before frame 4: Handle \"far\""),
                                   Not(HasSubstr("add[0]"))));
  }
}

TEST_F(Drag, PicksTheLastFrame) {
  for (const char* delivery : {"every", "latest"}) {
    // Options before the files: each --pick takes one point, and a negative one is no option.
    const Outcome outcome =
        Arapctl({"drag", "--pick", "12.25,8.5", "--pick", "-1,2", "--delivery", delivery, "--json",
                 Path("t.json"), "--spawn", Path("grid.obj"), Put("moved.json", kMoved)});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    // In the square at (2, 3), below its falling diagonal: square 26, the first of its two halves.
    EXPECT_THAT(outcome.out, HasSubstr("\npick 12.25,8.5: rest 2.25,3.5 in triangle 52\n"
                                       "pick -1,2: nothing there\n"));
    const auto picks = Json("t.json")["picks"];
    ASSERT_EQ(picks.size(), 2u);
    EXPECT_EQ(picks[0]["point"], (std::vector<double>{12.25, 8.5}));
    EXPECT_EQ(picks[0]["hit"], true);
    EXPECT_EQ(picks[0]["triangle"], 52);
    EXPECT_NEAR(picks[0]["rest"][0], 2.25, kAgree);
    EXPECT_NEAR(picks[0]["rest"][1], 3.5, kAgree);
    EXPECT_NEAR(picks[0]["bary"][0], 0.25, kAgree);
    EXPECT_NEAR(picks[0]["bary"][1], 0.25, kAgree);
    EXPECT_EQ(picks[1]["hit"], false);
    EXPECT_FALSE(picks[1].contains("triangle"));
  }
}

TEST_F(Drag, PickingNeedsAFrame) {
  const Outcome outcome =
      OnGrid("drag", R"({"handles": [{"rest": [1, 1]}], "frames": []})", {"--pick", "1,1"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("the track has none"));
}

TEST_F(Drag, TheServerLimitsPicks) {
  std::vector<std::string> picks;
  for (int i = 0; i < 1025; ++i) picks.insert(picks.end(), {"--pick", "1,1"});
  const Outcome outcome = OnGrid("drag", kMoved, picks);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("frame 1: "));
}

}  // namespace
}  // namespace arap::cli
