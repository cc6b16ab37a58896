// The core on the tracks of the samples and on every real mesh that the folder of ARAP_TEST_DATA
// holds, extreme frames included.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "client/cli/sample/samples.h"
#include "core/files/mesh_file.h"
#include "core/files/track_file.h"
#include "tests/support/compare.h"

namespace arap::cli {
namespace {

namespace fs = std::filesystem;

template <class T>
T Must(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << result.error().message;
    std::abort();
  }
  return *std::move(result);
}

class DataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("ARAP_TEST_DATA");
    if (data == nullptr) GTEST_SKIP() << "NOT CHECKED: ARAP_TEST_DATA does not name a folder";
    data_ = data;
  }
  fs::path data_;
};

// Every frame is finite, and what it says of its flips is what a recount finds. Answers the flips
// of all frames together.
std::size_t CheckTrack(const PlanarMesh& mesh, const Track& track, Basis basis) {
  const auto registered = Must(RegisteredMesh::Register(mesh, {basis, Weights::kUniform, {}}));
  std::vector<Handle> handles;
  for (const TrackHandle& entry : track.handles) handles.push_back(entry.handle);
  const auto set = Must(CompiledHandles::Compile(registered, handles));
  Deformer deformer(set);
  std::size_t flips = 0;
  for (const TrackFrame& frame : track.frames) {
    const ShapeQuality quality = Must(deformer.Update(frame.targets));
    EXPECT_TRUE(testing::AllFinite(deformer.positions())) << frame.kind;
    EXPECT_EQ(quality.flipped,
              testing::CountFlipped(registered->mesh().triangles, deformer.positions()))
        << frame.kind;
    EXPECT_EQ(quality.flipped, deformer.FlippedTriangles().size()) << frame.kind;
    // Handles meet their targets even where the shape collapses, coincident ones on the average.
    if (track.handles.size() < 8) {
      EXPECT_LE(quality.worst_handle_error, 1e-4 * registered->report().diagonal) << frame.kind;
    }
    flips += quality.flipped;
  }
  return flips;
}

void CheckFile(const fs::path& file, Basis basis) {
  SCOPED_TRACE(file.filename().string());
  const Track track = Must(ReadTrack(file.string()));
  const PlanarMesh mesh = Must(ReadPlanarMesh((file.parent_path() / track.mesh).string()));
  const std::size_t flips = CheckTrack(mesh, track, basis);
  // The tracks of 60 frames fold their meshes on purpose.
  if (track.frames.size() >= 60 && track.handles.size() < 8) {
    EXPECT_GT(flips, 0u);
  }
}

// The rest frame of the track once more, with its targets moved.
void AddFrame(const char* kind, Complex (*moved)(Complex), Track& track) {
  TrackFrame frame = track.frames.front();
  frame.kind = kind;
  for (Target& target : frame.targets) target.position = moved(target.position);
  track.frames.push_back(std::move(frame));
}

TEST(SampleTracks, AreFiniteAndTheirFlipsAreCounted) {
  const PlanarMesh bear = MakeCharacter(6), grid = MakeGrid(20, 20);
  for (const auto& [name, mesh, made] : {std::tuple{"bear", bear, MakeCharacterTrack(bear)},
                                         std::tuple{"grid", grid, MakeGridTrack(grid, 20, 20)}}) {
    Track track = made;
    AddFrame(
        "to one point", [](Complex) { return Complex(3, 4); }, track);
    AddFrame(
        "to one line", [](Complex p) { return Complex(p.real(), 0); }, track);
    AddFrame(
        "mirrored", [](Complex p) { return std::conj(p); }, track);
    AddFrame(
        "far away", [](Complex p) { return 1e6 + 10.0 * p; }, track);
    for (const Basis basis :
         {Basis::kEdge, Basis::kFace, Basis::kVertex, Basis::kEdgeAsPublished}) {
      SCOPED_TRACE(::testing::Message() << name << ", basis " << static_cast<int>(basis));
      EXPECT_GT(CheckTrack(mesh, track, basis), 0u) << "the mirrored frame folds the mesh";
    }
  }
}

TEST_F(DataTest, EveryTrackIsFiniteAndItsFlipsAreCounted) {
  std::size_t tracks = 0;
  for (const auto& entry : fs::directory_iterator(data_ / "2d")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".handles.json")) continue;
    ++tracks;
    CheckFile(entry.path(), Basis::kEdge);
    if (name.starts_with("char6_50k")) continue;  // once at full size
    CheckFile(entry.path(), Basis::kFace);
    CheckFile(entry.path(), Basis::kVertex);
    CheckFile(entry.path(), Basis::kEdgeAsPublished);
  }
  EXPECT_GE(tracks, 9u);
}

}  // namespace
}  // namespace arap::cli
