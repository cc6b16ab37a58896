#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "client/cli/sample/field.h"
#include "client/cli/sample/samples.h"
#include "core/drawing/svg.h"
#include "core/files/mesh_file.h"
#include "core/files/obj_writer.h"
#include "core/files/track.h"

namespace arap::cli {
namespace {

// Smallest angle in degrees; negative when a triangle is clockwise.
double SmallestAngle(const PlanarMesh& mesh) {
  double smallest = 180;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = mesh.vertices[t[k]];
      const Point b = mesh.vertices[t[(k + 1) % 3]], d = mesh.vertices[t[(k + 2) % 3]];
      smallest = std::min(smallest, std::arg((d - a) / (b - a)) * 180 / std::numbers::pi);
    }
  }
  return smallest;
}

// Vertices joined by triangles; every vertex has to be in one.
std::size_t Components(std::size_t vertex_count, std::span<const Triangle> triangles) {
  std::vector<std::size_t> root(vertex_count);
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : triangles) {
    root[find(t[0])] = find(t[1]);
    root[find(t[0])] = find(t[2]);
  }
  std::set<std::size_t> roots;
  for (std::size_t v = 0; v < vertex_count; ++v) roots.insert(find(v));
  return roots.size();
}

// One boundary, one component, Euler characteristic 1.
void ExpectDisk(std::size_t vertex_count, std::span<const Triangle> triangles) {
  EXPECT_EQ(Components(vertex_count, triangles), 1u);
  EXPECT_EQ(BoundaryLines(triangles).size(), 1u);
  std::set<std::pair<std::uint32_t, std::uint32_t>> directed, edges;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      EXPECT_TRUE(directed.emplace(a, b).second) << "edge " << a << " " << b << " twice";
      edges.emplace(std::min(a, b), std::max(a, b));
    }
  }
  EXPECT_EQ(vertex_count + triangles.size(), edges.size() + 1);
}

// Targets of the first frame and rest positions are one, and the anchors give the rest positions.
void ExpectStartsAtRest(const PlanarMesh& mesh, const Track& track) {
  for (std::size_t k = 0; k < track.handles.size(); ++k) {
    const TrackHandle& handle = track.handles[k];
    EXPECT_EQ(track.frames[0].targets[k].position, handle.rest);
    const auto& anchor = std::get<TriangleAnchor>(handle.handle.anchor);
    Point anchored = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GE(anchor.barycentric[c], 0) << handle.handle.id << " is outside";
      anchored += anchor.barycentric[c] * mesh.vertices[mesh.triangles[anchor.triangle][c]];
    }
    EXPECT_LT(std::abs(anchored - handle.rest), 1e-9);
  }
}

// The largest step of any handle between neighbouring frames, the last and the first among them.
double LargestStep(const Track& track) {
  double largest = 0;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    const auto& now = track.frames[i].targets;
    const auto& next = track.frames[(i + 1) % track.frames.size()].targets;
    for (std::size_t k = 0; k < now.size(); ++k) {
      largest = std::max(largest, std::abs(next[k].position - now[k].position));
    }
  }
  return largest;
}

class Character : public testing::TestWithParam<double> {};

TEST_P(Character, IsAWellShapedDisk) {
  const PlanarMesh mesh = MakeCharacter(GetParam());
  ExpectDisk(mesh.vertices.size(), mesh.triangles);
  EXPECT_GT(SmallestAngle(mesh), 20);
}

TEST_P(Character, IsTheSameEveryTime) {
  const PlanarMesh mesh = MakeCharacter(GetParam());
  EXPECT_EQ(FormatObj(mesh), FormatObj(MakeCharacter(GetParam())));
  EXPECT_EQ(FormatTrack(MakeCharacterTrack(mesh)), FormatTrack(MakeCharacterTrack(mesh)));
}

INSTANTIATE_TEST_SUITE_P(Edges, Character,
                         testing::Values(1.0, 2.3, 3.0, kCharacterEdge, 5.0, 6.7, 8.0));

TEST(CharacterTrack, StartsAtRestAndLoopsSmoothly) {
  const PlanarMesh mesh = MakeCharacter(kCharacterEdge);
  const Track track = MakeCharacterTrack(mesh);
  EXPECT_EQ(track.handles.size(), 5u);
  EXPECT_EQ(track.frames.size(), 120u);
  ExpectStartsAtRest(mesh, track);
  EXPECT_LT(LargestStep(track), 8);  // of 200 units of height
}

TEST(GridSample, IsADiskOfSquares) {
  const PlanarMesh mesh = MakeGrid(7, 4);
  EXPECT_EQ(mesh.vertices.size(), 28u);
  EXPECT_EQ(mesh.triangles.size(), 36u);
  ExpectDisk(mesh.vertices.size(), mesh.triangles);
  EXPECT_NEAR(SmallestAngle(mesh), 45, 1e-9);
  ExpectStartsAtRest(mesh, MakeGridTrack(mesh, 7, 4));
  const PlanarMesh smallest = MakeGrid(2, 2);
  ExpectDisk(smallest.vertices.size(), smallest.triangles);
  ExpectStartsAtRest(smallest, MakeGridTrack(smallest, 2, 2));
}

// In degrees.
double SmallestAngle(const SurfaceMesh& mesh) {
  double smallest = 180;
  for (std::size_t c = 0; c < 3 * mesh.triangles.size(); ++c) {
    const auto corner = [&](std::size_t k) {
      return mesh.vertices[mesh.triangles[c / 3][(c + k) % 3]];
    };
    const Point3 a = corner(0), b = corner(1), d = corner(2);
    double dot = 0, ab = 0, ad = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      dot += (b[i] - a[i]) * (d[i] - a[i]);
      ab += (b[i] - a[i]) * (b[i] - a[i]);
      ad += (d[i] - a[i]) * (d[i] - a[i]);
    }
    smallest = std::min(smallest, std::acos(dot / std::sqrt(ab * ad)) * 180 / std::numbers::pi);
  }
  return smallest;
}

class Garment : public testing::TestWithParam<double> {};

TEST_P(Garment, IsADiskOfUsefulTriangles) {
  const SurfaceMesh mesh = MakeGarment(GetParam());
  ExpectDisk(mesh.vertices.size(), mesh.triangles);
  EXPECT_GT(SmallestAngle(mesh), 15);
  EXPECT_EQ(FormatObj(mesh), FormatObj(MakeGarment(GetParam())));
}

INSTANTIATE_TEST_SUITE_P(Edges, Garment, testing::Values(0.8, kGarmentEdge, 5.0, 8.0));

class Face : public testing::TestWithParam<double> {};

TEST_P(Face, IsADiskThatLooksAlongZ) {
  const SurfaceMesh mesh = MakeFace(GetParam());
  ExpectDisk(mesh.vertices.size(), mesh.triangles);
  EXPECT_GT(SmallestAngle(mesh), 8);
  EXPECT_EQ(FormatObj(mesh), FormatObj(MakeFace(GetParam())));
  double z = 0;  // of the area vector
  for (const Triangle& t : mesh.triangles) {
    const Point3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    z += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }
  EXPECT_GT(z, 0);
}

INSTANTIATE_TEST_SUITE_P(Edges, Face, testing::Values(0.4, kFaceEdge, 2.0));

}  // namespace
}  // namespace arap::cli
