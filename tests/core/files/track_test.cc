#include "core/files/track.h"

#include <gmock/gmock.h>

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

std::string Complaint(const std::string& text) {
  const Result<Track> track = ParseTrack(text);
  return track ? "no fault" : track.error().message;
}

TEST(Track, ReadsHandlesAnchorsAndFrames) {
  const Result<Track> track = ParseTrack(kTrack);
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
  Result<Track> track = ParseTrack(kTrack);
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
  const Result<Track> track = ParseTrack(R"({"handles": [{"rest": [0, 0]}], "frames": []})");
  ASSERT_TRUE(track) << track.error().message;
  EXPECT_EQ(ToHandles(*track, false)[0].weight, Handle::kDefaultWeight);
}

TEST(Track, WhatIsWrittenReadsBackExactly) {
  const Result<Track> track = ParseTrack(kTrack);
  ASSERT_TRUE(track);
  const std::string text = FormatTrack(*track);
  const Result<Track> back = ParseTrack(text);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(FormatTrack(*back), text);
  EXPECT_EQ(back->frames[1].targets, track->frames[1].targets);
  EXPECT_EQ(back->row_weight, track->row_weight);
}

TEST(Track, GripsAnglesAndRigidityAreReadAndWritten) {
  const Result<Track> track = ParseTrack(R"({"w": 10, "rigidity": [1, 50],
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
  const Result<Track> back = ParseTrack(FormatTrack(*track));
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
  const Result<Track> track = ParseTrack(kEdits);
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
  EXPECT_EQ(&SegmentAt(segments, 1), &segments[0]);
  EXPECT_EQ(&SegmentAt(segments, 2), &segments[1]);
  EXPECT_EQ(&SegmentAt(segments, 3), &segments[2]);
  EXPECT_TRUE(ToHandles(*track, track->edits[0].add, /*hard=*/false)[0].hard);
  EXPECT_EQ(FormatTrack(*ParseTrack(FormatTrack(*track))), FormatTrack(*track));
  EXPECT_THAT(FormatTrack(*track), HasSubstr(R"("edits":[{"frame":2,"add":[{"name":"h2")"));
}

TEST(Track, AnEditBeforeTheFirstFrameLeavesNoEmptySegment) {
  const Result<Track> track = ParseTrack(R"({"handles": [{"rest": [0, 0]}],
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
  // A frame after an edit has as many targets as there are handles then.
  EXPECT_THAT(complaint(R"([{"frame": 1, "add": [{"rest": [0, 0]}]}])"),
              HasSubstr("frame 1 needs \"targets\""));
}

TEST(Track, FaultsSayWhatIsWrong) {
  EXPECT_THAT(Complaint("{"), HasSubstr("not a JSON object"));
  EXPECT_THAT(Complaint("[]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(Complaint("{}"), HasSubstr("\"handles\" and \"frames\""));
  EXPECT_THAT(Complaint(R"({"handles": [1], "frames": []})"), HasSubstr("handle 0 needs"));
  EXPECT_THAT(Complaint(R"({"handles": [{"rest": [1, "x"]}], "frames": []})"),
              HasSubstr("handle 0 needs \"rest\""));
  EXPECT_THAT(Complaint(R"({"handles": [{"rest": [1, 2], "triangle": -1}], "frames": []})"),
              HasSubstr("\"triangle\""));
  EXPECT_THAT(Complaint(R"({"handles": [{"rest": [1, 2], "vertex": 1.5}], "frames": []})"),
              HasSubstr("\"vertex\""));
  EXPECT_THAT(Complaint(R"({"handles": [{"rest": [1, 2]}], "frames": [{"targets": []}]})"),
              HasSubstr("frame 0"));
  EXPECT_THAT(Complaint(R"({"handles": [{"rest": [1, 2]}], "frames": [{"targets": [[1]]}]})"),
              HasSubstr("target 0"));
}

TEST(Track, AMissingFileIsNotFound) {
  const Result<Track> track = ReadTrack("/nowhere/track.json");
  ASSERT_FALSE(track);
  EXPECT_EQ(track.error().kind, FaultKind::kNotFound);
}

}  // namespace
}  // namespace arap
