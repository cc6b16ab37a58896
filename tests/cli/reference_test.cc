// bake --as-published against the paper in dense matrices on a mesh of our own, and against
// reference shapes of real meshes in the folder of test data that the environment variable
// ARAP_TEST_DATA names.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>

#include "client/cli/sample/samples.h"
#include "core/base/plane.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/track.h"
#include "core/files/track_file.h"
#include "tests/cli/run.h"
#include "tests/support/compare.h"
#include "tests/support/textbook.h"

namespace arap::cli {
namespace {

namespace fs = std::filesystem;

// The reference solves normal equations in double precision: that is as far as it can be trusted.
constexpr double kTolerance = 1e-6;  // of the diagonal
constexpr std::string_view kSuffix = ".paper64.csv";
constexpr std::string_view kAtVertices = ".vhandles";

std::vector<std::string> References() {
  std::vector<std::string> names;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing else runs yet.
  const char* const data = std::getenv("ARAP_TEST_DATA");
  if (data == nullptr) return names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(data) / "expected2d", error)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(kSuffix)) names.push_back(name.substr(0, name.size() - kSuffix.size()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

class Reference : public FolderTest {
 protected:
  // The track of a reference. Those "at vertices" hold the vertex nearest to each handle and name
  // no targets; where the reference has put the vertices is where they were pulled.
  static Result<Track> TrackOf(const fs::path& data, std::string name, const Csv& expected) {
    const bool at_vertices = name.ends_with(kAtVertices);
    if (at_vertices) name.resize(name.size() - kAtVertices.size());
    const std::string path = (data / "2d" / (name + ".handles.json")).string();
    Result<Track> track = ReadTrack(path);
    if (!track || !at_vertices) return track;
    MoveToVertices(Slurp(path), expected, *track);
    return track;
  }

 private:
  static void MoveToVertices(const std::string& text, const Csv& expected, Track& track) {
    // Only this test knows the member; the order of the handles is that of the file.
    constexpr std::string_view kMember = "\"nearest_vertex\":";
    std::size_t at = 0;
    std::vector<std::uint32_t> vertices;
    for (TrackHandle& handle : track.handles) {
      at = text.find(kMember, at);
      ASSERT_NE(at, std::string::npos);
      at += kMember.size();
      vertices.push_back(static_cast<std::uint32_t>(std::stoul(text.substr(at, 12))));
      handle.handle.anchor = VertexAnchor{vertices.back()};
    }
    for (std::size_t i = 0; i < expected.rows.size(); ++i) {
      std::vector<Target>& targets = track.frames[expected.frames[i]].targets;
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        const double* const xy = &expected.rows[i][2 * std::size_t{vertices[k]}];
        targets[k].position = {xy[0], xy[1]};
      }
    }
  }
};

// Largest distance between two shapes over vertices that the reference has.
double Distance(const std::vector<double>& actual, const std::vector<double>& expected) {
  double largest = 0;
  for (std::size_t k = 0; k + 1 < expected.size(); k += 2) {
    if (std::isnan(expected[k])) continue;
    largest =
        std::max(largest, std::hypot(actual[k] - expected[k], actual[k + 1] - expected[k + 1]));
  }
  return largest;
}

TEST_F(Reference, BakedShapesOfTheGridAreThoseOfThePaper) {
  constexpr std::size_t kSide = 8;
  const PlanarMesh mesh = MakeGrid(kSide, kSide);
  Track track = MakeGridTrack(mesh, kSide, kSide);
  // Only some frames: the judge takes its time. In the last one a corner is pulled in.
  track.frames = {track.frames[0], track.frames[10], track.frames[30], track.frames[30]};
  track.frames.back().targets.front().position += Complex(2.3, 1.1);
  const Outcome outcome =
      Arapctl({"bake", Put("grid.obj", FormatObj(mesh)), Put("grid.json", FormatTrack(track)),
               "--spawn", "--as-published", "--out", Path("shapes.csv")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Csv actual = ParseCsv(Slurp(Path("shapes.csv")));
  ASSERT_EQ(actual.rows.size(), track.frames.size());

  std::vector<testing::TextbookHandle> handles;
  for (const Handle& handle : ToHandles(track, /*hard=*/false)) {
    const auto& anchor = std::get<TriangleAnchor>(handle.anchor);
    handles.push_back({mesh.triangles[anchor.triangle], anchor.barycentric, handle.weight});
  }
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    std::vector<Complex> targets, shape;
    for (const Target& target : track.frames[i].targets) targets.push_back(target.position);
    const std::vector<double>& row = actual.rows[i];
    ASSERT_EQ(row.size(), 2 * mesh.vertices.size());
    for (std::size_t k = 0; k < row.size(); k += 2) shape.emplace_back(row[k], row[k + 1]);
    const std::vector<Complex> expected = testing::TextbookDeform(
        mesh, /*both_directions=*/false, Weights::kUniform, handles, targets);
    EXPECT_LT(testing::RelativeDistance(shape, expected), kTolerance) << "frame " << i;
  }
}

TEST_F(Reference, BakedShapesAreThePublishedOnes) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing else runs yet.
  const char* const data = std::getenv("ARAP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "NOT CHECKED: ARAP_TEST_DATA does not name a folder";
  const std::vector<std::string> references = References();
  ASSERT_FALSE(references.empty()) << "no *" << kSuffix << " in " << data << "/expected2d";

  for (const std::string& name : references) {
    SCOPED_TRACE(name);
    const Csv expected =
        ParseCsv(Slurp((fs::path(data) / "expected2d" / (name + std::string(kSuffix))).string()));
    const Result<Track> track = TrackOf(data, name, expected);
    ASSERT_TRUE(track) << track.error().message;
    const std::string mesh_path = (fs::path(data) / "2d" / track->mesh).string();
    const auto mesh = ReadPlanarMesh(mesh_path);
    ASSERT_TRUE(mesh) << mesh.error().message;
    Bounds bounds;
    bounds.Add(mesh->vertices);
    const double diagonal = std::hypot(bounds.width(), bounds.height());

    const Outcome outcome = Arapctl({"bake", mesh_path, Put("track.json", FormatTrack(*track)),
                                     "--spawn", "--as-published", "--out", Path("shapes.csv")});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Csv actual = ParseCsv(Slurp(Path("shapes.csv")));
    ASSERT_EQ(actual.rows.size(), track->frames.size());
    for (const auto& row : actual.rows) {
      ASSERT_EQ(row.size(), 2 * mesh->vertices.size());
      ASSERT_TRUE(std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); }));
    }
    double worst = 0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < expected.rows.size(); ++i) {
      const std::size_t frame = expected.frames[i];
      ASSERT_LT(frame, track->frames.size());
      // No rotation is defined there.
      if (track->frames[frame].kind == "collapse_all_to_one_point") continue;
      ASSERT_EQ(expected.rows[i].size(), 2 * mesh->vertices.size());
      const double distance = Distance(actual.rows[frame], expected.rows[i]) / diagonal;
      EXPECT_LT(distance, kTolerance) << "frame " << frame << " " << track->frames[frame].kind;
      worst = std::max(worst, distance);
      ++compared;
    }
    EXPECT_GT(compared, 0u);
    std::printf("%-24s %zu frames, worst %.2e of the diagonal\n", name.c_str(), compared, worst);
  }
}

}  // namespace
}  // namespace arap::cli
