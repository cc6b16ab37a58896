#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "client/cli/sample/character.h"
#include "client/cli/sample/face.h"
#include "client/cli/sample/garment.h"
#include "client/cli/sample/grid.h"
#include "client/cli/sample/point.h"
#include "core/drawing/svg/mesh_lines.h"
#include "core/files/mesh_file.h"

namespace arap::cli {
namespace {

Point Vertex(const client::PlanarMesh& mesh, std::size_t v) {
  return {mesh.vertices[2 * v], mesh.vertices[2 * v + 1]};
}

// Smallest angle in degrees; negative when a triangle is clockwise.
double SmallestAngle(const client::PlanarMesh& mesh) {
  double smallest = 180;
  for (std::size_t c = 0; c < mesh.triangles.size(); ++c) {
    const std::size_t first = c / 3 * 3;
    const Point a = Vertex(mesh, mesh.triangles[c]);
    const Point b = Vertex(mesh, mesh.triangles[first + (c + 1) % 3]);
    const Point d = Vertex(mesh, mesh.triangles[first + (c + 2) % 3]);
    smallest = std::min(smallest, std::arg((d - a) / (b - a)) * 180 / std::numbers::pi);
  }
  return smallest;
}

// Vertices joined by triangles; every vertex has to be in one.
std::size_t Components(std::size_t vertex_count, std::span<const std::uint32_t> triangles) {
  std::vector<std::size_t> root(vertex_count);
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    root[find(triangles[t])] = find(triangles[t + 1]);
    root[find(triangles[t])] = find(triangles[t + 2]);
  }
  std::set<std::size_t> roots;
  for (std::size_t v = 0; v < vertex_count; ++v) roots.insert(find(v));
  return roots.size();
}

// One boundary, one component, Euler characteristic 1.
void ExpectDisk(std::size_t vertex_count, std::span<const std::uint32_t> triangles) {
  EXPECT_EQ(Components(vertex_count, triangles), 1u);
  EXPECT_EQ(BoundaryLines(triangles).size(), 1u);
  std::set<std::pair<std::uint32_t, std::uint32_t>> directed, edges;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t + k], b = triangles[t + (k + 1) % 3];
      EXPECT_TRUE(directed.emplace(a, b).second) << "edge " << a << " " << b << " twice";
      edges.emplace(std::min(a, b), std::max(a, b));
    }
  }
  EXPECT_EQ(vertex_count + triangles.size() / 3, edges.size() + 1);
}

// Targets of the first frame and rest positions are one, and the anchors give the rest positions.
void ExpectStartsAtRest(const client::PlanarMesh& mesh, const Track& track) {
  for (std::size_t k = 0; k < track.handles.size(); ++k) {
    const TrackHandle& handle = track.handles[k];
    const Point rest(handle.rest_x, handle.rest_y);
    EXPECT_EQ(Point(track.frames[0].targets[2 * k], track.frames[0].targets[2 * k + 1]), rest);
    const auto& anchor = std::get<client::TriangleAnchor>(handle.anchor);
    Point anchored = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GE(anchor.barycentric[c], 0) << handle.name << " is outside";
      anchored += anchor.barycentric[c] * Vertex(mesh, mesh.triangles[3 * anchor.triangle + c]);
    }
    EXPECT_LT(std::abs(anchored - rest), 1e-9);
  }
}

// The largest step of any handle between neighbouring frames, the last and the first among them.
double LargestStep(const Track& track) {
  double largest = 0;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    const auto& now = track.frames[i].targets;
    const auto& next = track.frames[(i + 1) % track.frames.size()].targets;
    for (std::size_t k = 0; k < now.size(); k += 2) {
      largest = std::max(largest, std::hypot(next[k] - now[k], next[k + 1] - now[k + 1]));
    }
  }
  return largest;
}

class Character : public testing::TestWithParam<double> {};

TEST_P(Character, IsAWellShapedDisk) {
  const client::PlanarMesh mesh = MakeCharacter(GetParam());
  ExpectDisk(mesh.vertex_count(), mesh.triangles);
  EXPECT_GT(SmallestAngle(mesh), 20);
}

TEST_P(Character, IsTheSameEveryTime) {
  const client::PlanarMesh mesh = MakeCharacter(GetParam());
  EXPECT_EQ(FormatObj(mesh), FormatObj(MakeCharacter(GetParam())));
  EXPECT_EQ(FormatTrack(MakeCharacterTrack(mesh)), FormatTrack(MakeCharacterTrack(mesh)));
}

INSTANTIATE_TEST_SUITE_P(Edges, Character,
                         testing::Values(1.0, 2.3, 3.0, kCharacterEdge, 5.0, 6.7, 8.0));

TEST(CharacterTrack, StartsAtRestAndLoopsSmoothly) {
  const client::PlanarMesh mesh = MakeCharacter(kCharacterEdge);
  const Track track = MakeCharacterTrack(mesh);
  EXPECT_EQ(track.handles.size(), 5u);
  EXPECT_EQ(track.frames.size(), 120u);
  ExpectStartsAtRest(mesh, track);
  EXPECT_LT(LargestStep(track), 8);  // of 200 units of height
}

TEST(GridSample, IsADiskOfSquares) {
  const client::PlanarMesh mesh = MakeGrid(7, 4);
  EXPECT_EQ(mesh.vertex_count(), 28u);
  EXPECT_EQ(mesh.triangle_count(), 36u);
  ExpectDisk(mesh.vertex_count(), mesh.triangles);
  EXPECT_NEAR(SmallestAngle(mesh), 45, 1e-9);
  ExpectStartsAtRest(mesh, MakeGridTrack(mesh, 7, 4));
  const client::PlanarMesh smallest = MakeGrid(2, 2);
  ExpectDisk(smallest.vertex_count(), smallest.triangles);
  ExpectStartsAtRest(smallest, MakeGridTrack(smallest, 2, 2));
}

// In degrees.
double SmallestAngle(const client::SurfaceMesh& mesh) {
  double smallest = 180;
  for (std::size_t c = 0; c < mesh.triangles.size(); ++c) {
    const auto corner = [&](std::size_t k) {
      return &mesh.vertices[3 * mesh.triangles[c / 3 * 3 + (c + k) % 3]];
    };
    const double *a = corner(0), *b = corner(1), *d = corner(2);
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
  const client::SurfaceMesh mesh = MakeGarment(GetParam());
  ExpectDisk(mesh.vertex_count(), mesh.triangles);
  EXPECT_GT(SmallestAngle(mesh), 15);
  EXPECT_EQ(FormatObj(mesh), FormatObj(MakeGarment(GetParam())));
}

INSTANTIATE_TEST_SUITE_P(Edges, Garment, testing::Values(0.8, kGarmentEdge, 5.0, 8.0));

class Face : public testing::TestWithParam<double> {};

TEST_P(Face, IsADiskThatLooksAlongZ) {
  const client::SurfaceMesh mesh = MakeFace(GetParam());
  ExpectDisk(mesh.vertex_count(), mesh.triangles);
  EXPECT_GT(SmallestAngle(mesh), 8);
  EXPECT_EQ(FormatObj(mesh), FormatObj(MakeFace(GetParam())));
  double z = 0;  // of the area vector
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const auto corner = [&](std::size_t k) { return &mesh.vertices[3 * mesh.triangles[t + k]]; };
    const double *a = corner(0), *b = corner(1), *c = corner(2);
    z += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }
  EXPECT_GT(z, 0);
}

INSTANTIATE_TEST_SUITE_P(Edges, Face, testing::Values(0.4, kFaceEdge, 2.0));

}  // namespace
}  // namespace arap::cli
