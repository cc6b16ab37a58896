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

template <class Mesh>
std::vector<Triangle> TrianglesOf(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    triangles.push_back({mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]});
  }
  return triangles;
}

PlanarMesh ReadPlane(const fs::path& file) {
  const client::PlanarMesh read = Must(ReadPlanarMesh(file.string()));
  PlanarMesh mesh{{}, TrianglesOf(read)};
  for (std::size_t i = 0; i < read.vertices.size(); i += 2) {
    mesh.vertices.emplace_back(read.vertices[i], read.vertices[i + 1]);
  }
  return mesh;
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

std::vector<Handle> HandlesOf(const Track& track) {
  std::vector<Handle> handles;
  for (const TrackHandle& h : track.handles) {
    Handle handle;
    handle.id = h.name;
    const auto& anchor = std::get<client::TriangleAnchor>(h.anchor);
    handle.anchor = TriangleAnchor{anchor.triangle, anchor.barycentric};
    handles.push_back(handle);
  }
  return handles;
}

// Every frame is finite, and what it says of its flips is what a recount finds.
void CheckTrack(const fs::path& file, Basis basis) {
  SCOPED_TRACE(file.filename().string());
  const Track track = Must(ReadTrack(file.string()));
  const PlanarMesh mesh = ReadPlane(file.parent_path() / track.mesh);
  const auto registered = Must(RegisteredMesh::Register(mesh, {basis, Weights::kUniform, {}}));
  const auto set = Must(CompiledHandles::Compile(registered, HandlesOf(track)));
  Deformer deformer(set);
  std::size_t flips = 0;
  for (const TrackFrame& frame : track.frames) {
    std::vector<Target> targets;
    for (std::size_t i = 0; i < frame.targets.size(); i += 2) {
      targets.push_back({{frame.targets[i], frame.targets[i + 1]}, 0, 1});
    }
    const ShapeQuality quality = Must(deformer.Update(targets));
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
