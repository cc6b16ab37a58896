// The core on every real mesh that the folder of ARAP_TEST_DATA holds, extreme frames included.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "core/files/mesh_file.h"
#include "core/files/track.h"
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

// Every frame is finite, and what it says of its flips is what a recount finds.
void CheckTrack(const fs::path& file, Basis basis) {
  SCOPED_TRACE(file.filename().string());
  const Track track = Must(ReadTrack(file.string()));
  const PlanarMesh mesh = Must(ReadPlanarMesh((file.parent_path() / track.mesh).string()));
  const auto registered = Must(RegisteredMesh::Register(mesh, {basis, Weights::kUniform, {}}));
  std::vector<Handle> handles;
  for (const TrackHandle& entry : track.handles) handles.push_back(entry.handle);
  const auto set = Must(CompiledHandles::Compile(registered, handles));
  Deformer deformer(set);
  std::size_t flips = 0;
  for (const TrackFrame& frame : track.frames) {
    const ShapeQuality quality = Must(deformer.Update(frame.targets));
    ASSERT_TRUE(testing::AllFinite(deformer.positions())) << frame.kind;
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
  // The tracks of 60 frames fold their meshes on purpose.
  if (track.frames.size() >= 60 && track.handles.size() < 8) {
    EXPECT_GT(flips, 0u);
  }
}

TEST_F(DataTest, EveryTrackIsFiniteAndItsFlipsAreCounted) {
  std::size_t tracks = 0;
  for (const auto& entry : fs::directory_iterator(data_ / "2d")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".handles.json")) continue;
    ++tracks;
    CheckTrack(entry.path(), Basis::kEdge);
    if (name.starts_with("char6_50k")) continue;  // once at full size
    CheckTrack(entry.path(), Basis::kFace);
    CheckTrack(entry.path(), Basis::kVertex);
    CheckTrack(entry.path(), Basis::kEdgeAsPublished);
  }
  EXPECT_GE(tracks, 9u);
}

}  // namespace
}  // namespace arap::cli
