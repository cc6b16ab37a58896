#include "core/files/track.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/files/track_file.h"
#include "tests/support/folder.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kTrack = R"({
  "mesh": "a.obj", "bbox_diag": 3, "w": 1000, "extra": [1],
  "handles": [
    {"name": "head", "rest": [1, 2.5], "triangle": 7, "bary": [0.25, 0.25, 0.5], "nearest_vertex": 3},
    {"rest": [0, 0], "vertex": 4},
    {"name": "tail", "rest": [-1, 0]}],
  "frames": [{"i": 0, "kind": "rest", "targets": [[1, 2.5], [0, 0], [-1, 0]]},
             {"targets": [[2, 2], [0, 0], [-1, 1e-3]]}]})";

Result<Track> Parse(std::string_view json) { return ParseTrack(json, "t.json"); }

std::vector<TrackSegment> SegmentsOf(const Track& track) {
  TrackSegments segments(track);
  std::vector<TrackSegment> all{segments.segment()};
  while (segments.Next()) all.push_back(segments.segment());
  return all;
}

std::string Complaint(const std::string& text) {
  const Result<Track> track = Parse(text);
  return track ? "no fault" : track.error().message;
}

TEST(Track, ReadsHandlesAnchorsAndFrames) {
  const Result<Track> track = Parse(kTrack);
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_EQ(track->mesh, "a.obj");
  ASSERT_EQ(track->handles.size(), 3u);
  const auto& anchor = std::get<TriangleAnchor>(track->handles[0].handle.anchor);
  EXPECT_EQ(anchor.triangle, 7u);
  EXPECT_THAT(anchor.barycentric, ElementsAre(0.25, 0.25, 0.5));
  EXPECT_EQ(track->handles[0].rest, Complex(1, 2.5));
  EXPECT_EQ(track->handles[1].handle.id, "h1");
  EXPECT_EQ(std::get<VertexAnchor>(track->handles[1].handle.anchor).vertex, 4u);
  EXPECT_EQ(std::get<PointAnchor>(track->handles[2].handle.anchor).position, Complex(-1, 0));
  ASSERT_EQ(track->frames.size(), 2u);
  EXPECT_EQ(track->frames[0].kind, "rest");
  EXPECT_THAT(track->frames[1].targets,
              ElementsAre(Target{{2, 2}}, Target{{0, 0}}, Target{{-1, 1e-3}}));
}

TEST(Track, TheEnergyWeightIsTheSquareOfTheRowWeight) {
  Result<Track> track = Parse(kTrack);
  ASSERT_TRUE(track);
  EXPECT_EQ(track->row_weight, 1000);
  EXPECT_EQ(ToHandles(*track, /*hard=*/false)[0].weight, 1e6);
  track->row_weight = 30;
  EXPECT_EQ(ToHandles(*track, /*hard=*/false)[0].weight, 900);
  EXPECT_FALSE(ToHandles(*track, false)[0].hard);
  EXPECT_TRUE(ToHandles(*track, true)[0].hard);
  EXPECT_EQ(ToHandles(*track, true)[0].weight, Handle::kDefaultWeight);
  const std::vector<TrackSegment> segments = SegmentsOf(*track);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_THAT(segments[0].ids, ElementsAre("head", "h1", "tail"));
}

TEST(Track, WithoutAWeightItIsTheDefault) {
  const Result<Track> track = Parse(R"({"handles": [{"rest": [0, 0]}], "frames": []})");
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_EQ(ToHandles(*track, false)[0].weight, Handle::kDefaultWeight);
}

TEST(Track, WhatIsWrittenReadsBackExactly) {
  const Result<Track> track = Parse(kTrack);
  ASSERT_TRUE(track);
  const std::string text = FormatTrack(*track);
  const Result<Track> back = Parse(text);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(FormatTrack(*back), text);
  EXPECT_EQ(back->frames[1].targets, track->frames[1].targets);
  EXPECT_EQ(back->row_weight, track->row_weight);
}

TEST(Track, GripsAnglesAndRigidityAreReadAndWritten) {
  const Result<Track> track = Parse(R"({"w": 10, "rigidity": [1, 50],
    "handles": [{"rest": [0, 0], "weight": 7, "oriented": true, "area_radius": 2, "snap": true,
                 "depth": 3, "depth_falloff": 4}, {"rest": [1, 0], "hard": true}],
    "frames": [{"targets": [[0, 0], [1, 1]], "angles": [0.5, 0], "scales": [2, 1]}]})");
  ASSERT_TRUE(track) << track.error().message;
  const auto handles = ToHandles(*track, /*hard=*/false);
  EXPECT_EQ(handles[0].weight, 7);
  EXPECT_TRUE(handles[0].oriented && handles[0].outside == Outside::kSnap && !handles[0].hard);
  EXPECT_EQ(handles[0].area_radius, 2);
  EXPECT_EQ(handles[0].depth, 3);
  EXPECT_EQ(handles[0].depth_falloff, 4);
  EXPECT_TRUE(handles[1].hard);
  EXPECT_EQ(handles[1].weight, Handle::kDefaultWeight);
  EXPECT_THAT(track->frames[0].targets, ElementsAre(Target{{0, 0}, 0.5, 2}, Target{{1, 1}, 0, 1}));
  EXPECT_THAT(track->rigidity, ElementsAre(1, 50));
  const Result<Track> back = Parse(FormatTrack(*track));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(FormatTrack(*back), FormatTrack(*track));
}

constexpr const char* kEdits = R"({
  "handles": [{"name": "a", "rest": [0, 0]}, {"rest": [1, 0]}],
  "frames": [{"targets": [[0, 0], [1, 0]]}, {"targets": [[0, 0], [1, 0]]},
             {"targets": [[1, 1], [2, 2], [3, 3]]}, {"targets": [[4, 4], [5, 5], [6, 6]]}],
  "edits": [{"frame": 2, "add": [{"rest": [0, 1], "hard": true}]},
            {"frame": 3, "remove": ["a"], "add": [{"name": "a", "rest": [2, 0], "vertex": 9}]}]})";

TEST(Track, EditsCutItIntoSegments) {
  const Result<Track> track = Parse(kEdits);
  ASSERT_TRUE(track) << track.error().message;
  const std::vector<TrackSegment> segments = SegmentsOf(*track);
  ASSERT_EQ(segments.size(), 3u);
  EXPECT_EQ(segments[0].first, 0u);
  EXPECT_EQ(segments[0].end, 2u);
  EXPECT_EQ(segments[0].edit, nullptr);
  EXPECT_THAT(segments[0].ids, ElementsAre("a", "h1"));
  EXPECT_EQ(segments[1].first, 2u);
  EXPECT_EQ(segments[1].end, 3u);
  EXPECT_EQ(segments[1].edit, &track->edits[0]);
  EXPECT_THAT(segments[1].ids, ElementsAre("a", "h1", "h2"));
  EXPECT_EQ(segments[2].end, 4u);
  // Another handle under the name of one that went.
  EXPECT_THAT(segments[2].ids, ElementsAre("h1", "h2", "a"));
  EXPECT_THAT(segments[2].numbers, ElementsAre(1, 2, 3));
  TrackSegments walk(*track);
  for (const auto& [frame, first] : {std::pair(1u, 0u), {2u, 2u}, {2u, 2u}, {3u, 3u}}) {
    EXPECT_EQ(walk.At(frame).first, first);
  }
  EXPECT_EQ(TrackSegments(*track).At(3).first, 3u);
  EXPECT_EQ(EditBefore(*track, 1), nullptr);
  EXPECT_EQ(EditBefore(*track, 2), &track->edits[0]);
  EXPECT_EQ(EditBefore(*track, 4), nullptr);
  EXPECT_TRUE(ToHandles(*track, track->edits[0].add, /*hard=*/false)[0].hard);
  EXPECT_EQ(FormatTrack(*Parse(FormatTrack(*track))), FormatTrack(*track));
  EXPECT_THAT(FormatTrack(*track), HasSubstr(R"("edits":[{"frame":2,"add":[{"name":"h2")"));
}

TEST(Track, AnEditBeforeTheFirstFrameLeavesNoEmptySegment) {
  const Result<Track> track = Parse(R"({"handles": [{"rest": [0, 0]}],
    "frames": [{"targets": []}], "edits": [{"frame": 0, "remove": ["h0"]}]})");
  ASSERT_TRUE(track) << track.error().message;
  const std::vector<TrackSegment> segments = SegmentsOf(*track);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(segments[0].edit, &track->edits[0]);
  EXPECT_THAT(segments[0].ids, ElementsAre());
  EXPECT_EQ(segments[0].end, 1u);
}

TEST(Track, FaultsOfEditsSayWhichAndWhat) {
  const auto complaint = [](const std::string& edits) {
    return Complaint(R"({"handles": [{"rest": [1, 2]}], "frames": [{"targets": [[1, 2]]},
                        {"targets": [[1, 2]]}], "edits": )" +
                     edits + "}");
  };
  EXPECT_EQ(complaint("[]"), "no fault");
  EXPECT_THAT(complaint("7"), HasSubstr("\"edits\" is not an array"));
  EXPECT_THAT(complaint("[7]"), HasSubstr("edit 0 needs \"frame\""));
  EXPECT_THAT(complaint(R"([{"remove": ["h0"]}])"), HasSubstr("edit 0 needs \"frame\""));
  EXPECT_THAT(complaint(R"([{"frame": 1}])"), HasSubstr("\"remove\" or \"add\""));
  EXPECT_THAT(complaint(R"([{"frame": 1, "remove": "h0"}])"), HasSubstr("are arrays"));
  EXPECT_THAT(complaint(R"([{"frame": 1, "remove": [0]}])"), HasSubstr("has names"));
  EXPECT_THAT(complaint(R"([{"frame": 1, "add": [{"name": "b"}]}])"),
              HasSubstr("edit 0: handle 0 needs \"rest\""));
  EXPECT_THAT(complaint(R"([{"frame": 1, "remove": ["b"]}])"),
              HasSubstr("edit 0 removes \"b\", which is not there"));
  EXPECT_THAT(complaint(R"([{"frame": 2, "remove": ["h0"]}])"), HasSubstr("frames of the track"));
  EXPECT_THAT(complaint(R"([{"frame": 1, "add": [{"rest": [0, 0]}]},
                            {"frame": 1, "remove": ["h0"]}])"),
              HasSubstr("edit 1: the frames of edits"));
  // Where it stands.
  EXPECT_EQ(Complaint("{\"handles\": [],\n \"frames\": [{\"targets\": []}], \"edits\": [\n"
                      "  {\"frame\": 0,\n   \"remove\": [\"b\"]}]}"),
            "t.json:4:14: edit 0 removes \"b\", which is not there");
}

TEST(Track, FaultsSayWhatIsWrongAndWhere) {
  const std::pair<const char*, const char*> cases[] = {
      {"{", "t.json:1:2: not JSON: unexpected end of input; expected string literal"},
      {"{\"handles\": [],\r\n \"frames\": [],,}",
       "t.json:2:15: not JSON: unexpected ','; expected string literal"},
      {"[]", "t.json:1:1: not a JSON object"},
      {"{}", "t.json:1:1: a track needs the arrays \"handles\" and \"frames\""},
      {R"({"handles": [1], "frames": []})", "t.json:1:14: handle 0 needs \"rest\": [x, y]"},
      {"{\"handles\": [{\"rest\": [1, 2]},\n {\"rest\": [1, \"x\"]}], \"frames\": []}",
       "t.json:2:2: handle 1 needs \"rest\": [x, y]"},
      {R"({"handles": [{"rest": [1, 2], "triangle": -1}], "frames": []})",
       "t.json:1:14: handle 0 needs \"triangle\": index with \"bary\": [a, b, c]"},
      {R"({"handles": [{"rest": [1, 2], "vertex": 1.5}], "frames": []})",
       "t.json:1:14: handle 0: \"vertex\" is not an index"},
      {R"({"handles": [{"rest": [1, 2]}], "frames": [{"targets": 7}]})",
       "t.json:1:56: frame 0 needs \"targets\" with a pair or null for each of 1 handles"},
      {R"({"handles": [{"rest": [1, 2]}], "frames": [{}]})",
       "t.json:1:44: frame 0 needs \"targets\" with a pair or null for each of 1 handles"},
      {R"({"handles": [], "frames": [{"targets": [[1, 2]]}]})",
       "t.json:1:40: frame 0 needs \"targets\" with a pair or null for each of 0 handles"},
      {"{\"handles\": [{\"rest\": [1, 2]}], \"frames\": [\n{\"targets\": [[1]]}]}",
       "t.json:2:14: frame 0: target 0 is neither [x, y] nor null"},
      {R"({"handles": [{"rest": [1, 2]}], "frames": [{"targets": [null], "angles": ["a"]}]})",
       "t.json:1:75: frame 0: element 0 of angles is neither a number nor null"},
      {R"({"handles": [{"rest": [1, 2]}], "frames": [{"targets": [null], "scales": [1, 2]}]})",
       "t.json:1:74: frame 0: angles and scales have one number per handle"},
      {R"({"rigidity": [1, "x"], "handles": [], "frames": []})",
       "t.json:1:14: \"rigidity\" is not an array of numbers"},
  };
  for (const auto& [text, fault] : cases) EXPECT_EQ(Complaint(text), fault) << text;
}

// A marker that was lost: null, or at the end of the list nothing.
TEST(Track, LostMarkersKeepTheirLastTarget) {
  const Result<Track> track = Parse(R"({
    "handles": [{"name": "a", "rest": [0, 10]}, {"name": "b", "rest": [50, 10]},
                {"name": "c", "rest": [100, 10]}],
    "frames": [{"targets": [[0, 10], null, [100, 20]]},
               {"targets": [[0, 10], [50, 15], [100, 30]]},
               {"targets": [[0, 11], null]},
               {"targets": []},
               {"targets": [[0, 12], [50, 20], [100, 40]]}]})");
  ASSERT_TRUE(track) << track.error().message;
  const auto at = [&](std::size_t frame) { return track->frames[frame].targets; };
  EXPECT_THAT(at(0), ElementsAre(Target{{0, 10}}, Target{{50, 10}}, Target{{100, 20}}));
  EXPECT_THAT(at(1), ElementsAre(Target{{0, 10}}, Target{{50, 15}}, Target{{100, 30}}));
  EXPECT_THAT(at(2), ElementsAre(Target{{0, 11}}, Target{{50, 15}}, Target{{100, 30}}));
  EXPECT_EQ(at(3), at(2));
  EXPECT_THAT(at(4), ElementsAre(Target{{0, 12}}, Target{{50, 20}}, Target{{100, 40}}));
  ASSERT_EQ(track->warnings.size(), 1u);
  EXPECT_EQ(track->warnings[0].kind, "kept_targets");
  EXPECT_EQ(track->warnings[0].count, 6u);
  EXPECT_EQ(track->warnings[0].message,
            "t.json: 6 targets are null or missing, the first that of handle \"b\" in frame 0; a "
            "handle without one keeps what it had before");
  EXPECT_TRUE(Parse(FormatTrack(*track))->warnings.empty());
}

TEST(Track, LostMarkersKeepAnglesAndScalesUnlessTheyAreGiven) {
  const Result<Track> track = Parse(R"({
    "handles": [{"rest": [0, 0], "oriented": true}, {"rest": [1, 0], "oriented": true}],
    "frames": [{"targets": [[2, 2], [3, 3]], "angles": [0.5, 1], "scales": [2, 3]},
               {"targets": [null, [4, 4]], "angles": [0.7, null]},
               {"targets": [null, [5, 5]]}]})");
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_THAT(track->frames[1].targets, ElementsAre(Target{{2, 2}, 0.7, 2}, Target{{4, 4}, 1, 1}));
  EXPECT_THAT(track->frames[2].targets, ElementsAre(Target{{2, 2}, 0.7, 2}, Target{{5, 5}, 0, 1}));
  EXPECT_EQ(track->warnings.at(0).count, 3u);
}

// Under its name there may have been another one.
TEST(Track, AHandleThatIsAddedStartsAtItsOwnRestPlace) {
  const Result<Track> track = Parse(R"({
    "handles": [{"name": "a", "rest": [0, 0]}],
    "frames": [{"targets": [[7, 7]]}, {"targets": [null]}, {"targets": [null]}],
    "edits": [{"frame": 2, "remove": ["a"], "add": [{"name": "a", "rest": [1, 2]}]}]})");
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_THAT(track->frames[1].targets, ElementsAre(Target{{7, 7}}));
  EXPECT_THAT(track->frames[2].targets, ElementsAre(Target{{1, 2}}));
}

// What is not written takes no more memory than what is.
TEST(Track, AShortTextAsksForNoMoreTargetsThanItIsLong) {
  std::string text = R"({"handles": [)";
  for (int i = 0; i < 1000; ++i) text += R"({"rest": [0, 0]},)";
  text.back() = ']';
  text += R"(, "frames": [)";
  for (int i = 0; i < 1000; ++i) text += R"({"targets": []},)";
  text.back() = ']';
  EXPECT_THAT(Complaint(text + "}"),
              HasSubstr("targets are missing at the ends of lists; write null"));
}

class TrackFiles : public FolderTest {};

constexpr const char* kWritten = R"({
  "handles": [{"name": "a", "rest": [0, 10]},
    {"name": "b", "rest": [50, 10]}],
  "frames": [
    {"targets": [[0, 10], [50, 10]]},
    {"targets": [[0, 11], [50, 12.5]], "angles": [0.5, 0]}
  ]
}
)";

// What takes the place of a part of it: the fault is at the @.
struct Wrong {
  const char* part;
  const char* with;
  const char* complaint;
};
constexpr Wrong kWrong[] = {
    {"12.5", "@NaN", "not JSON: invalid literal"},
    {"12.5", "1e99@9", "not JSON: number overflow"},
    {"[50, 12.5]", "@[50, 12,5]", "frame 1: target 1 is neither [x, y] nor null"},
    {"[50, 12.5]", "@\"x\"", "frame 1: target 1 is neither [x, y] nor null"},
    {"[[0, 11], [50, 12.5]]", "@[[0, 11], [50, 12.5], [1, 1]]",
     "frame 1 needs \"targets\" with a pair or null for each of 2 handles"},
    {"[0.5, 0]", "[0.5, @\"0\"]", "frame 1: element 1 of angles is neither a number nor null"},
    {"{\"name\": \"b\", \"rest\": [50, 10]}", "@{\"name\": \"b\"}",
     "handle 1 needs \"rest\": [x, y]"},
    {"[50, 10]}],", "[50, 10]}]@],", "not JSON: unexpected ']'"},
};

// In every form that programs write texts in, and with every fault.
TEST_F(TrackFiles, Battery) {
  const std::string plain = FormatTrack(*Parse(kWritten));
  std::vector<std::optional<Wrong>> faults(std::begin(kWrong), std::end(kWrong));
  faults.emplace_back();
  for (const std::optional<Wrong>& wrong : faults) {
    std::string text = kWritten, place;
    if (wrong) {
      text.replace(text.find(wrong->part), std::strlen(wrong->part), wrong->with);
      const std::size_t at = text.find('@');
      text.erase(at, 1);
      const std::string before = text.substr(0, at);
      place = fmt::format(":{}:{}: ", std::count(before.begin(), before.end(), '\n') + 1,
                          at - before.rfind('\n'));
    }
    for (const char* mark : {"", "\xef\xbb\xbf"}) {
      for (const char* end : {"\n", "\r\n", "\r"}) {
        for (const bool tabs : {false, true}) {
          std::string written = mark;
          for (const char c : text) {
            if (c == '\n') {
              written += end;
            } else {
              written += c == ' ' && tabs ? '\t' : c;
            }
          }
          const std::string path = Put("t.json", written);
          SCOPED_TRACE(written);
          const Result<Track> track = ReadTrack(path);
          EXPECT_EQ(track.has_value(), !wrong);
          if (track) {
            EXPECT_EQ(FormatTrack(*track), plain);
          } else if (wrong) {
            EXPECT_THAT(track.error().message, ::testing::StartsWith(path + place));
            EXPECT_THAT(track.error().message, HasSubstr(wrong->complaint));
          }
        }
      }
    }
  }
}

TEST(Track, AMissingFileIsNotFound) {
  const Result<Track> track = ReadTrack("/nowhere/track.json");
  ASSERT_FALSE(track);
  EXPECT_EQ(track.error().kind, FaultKind::kNotFound);
}

}  // namespace
}  // namespace arap
