#include "core/mesh/validation.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/meshes.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Fault FaultOf(PlanarMesh mesh, const MeshLimits& limits = {}) {
  auto result = ValidatePlanar(mesh, limits);
  EXPECT_FALSE(result.has_value());
  return result ? Fault{} : result.error();
}

TEST(ValidationTest, AcceptsAGoodMeshWithoutWarnings) {
  PlanarMesh mesh = Square();
  const auto warnings = ValidatePlanar(mesh, {});
  ASSERT_TRUE(warnings.has_value());
  EXPECT_TRUE(warnings->empty());
}

TEST(ValidationTest, NamesAnEmptyMesh) {
  EXPECT_EQ(FaultOf({}).kind, FaultKind::kEmptyMesh);
  EXPECT_EQ(FaultOf({{{0, 0}}, {}}).kind, FaultKind::kEmptyMesh);
}

TEST(ValidationTest, NamesTheLimit) {
  const Fault vertices = FaultOf(Square(), {3, 100});
  EXPECT_EQ(vertices.kind, FaultKind::kMeshTooLarge);
  EXPECT_THAT(vertices.message, HasSubstr("4 elements, more than max_vertices of 3."));
  EXPECT_EQ(FaultOf(Square(), {100, 1}).kind, FaultKind::kMeshTooLarge);
}

TEST(ValidationTest, NamesTheNonFiniteVertex) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), -2 * kMaxCoordinate}) {
    PlanarMesh mesh = Square();
    mesh.vertices[2] = {1, bad};
    const Fault fault = FaultOf(mesh);
    EXPECT_EQ(fault.kind, FaultKind::kNonFiniteCoordinate);
    EXPECT_THAT(fault.elements, ElementsAre(2));
  }
}

TEST(ValidationTest, NamesTheTriangleWithABadIndex) {
  PlanarMesh mesh = Square();
  mesh.triangles[1][2] = 4;
  const Fault fault = FaultOf(mesh);
  EXPECT_EQ(fault.kind, FaultKind::kIndexOutOfRange);
  EXPECT_THAT(fault.elements, ElementsAre(1));
  mesh.triangles[1] = {0, 2, 2};
  EXPECT_EQ(FaultOf(mesh).kind, FaultKind::kRepeatedIndex);
}

TEST(ValidationTest, NamesTheDegenerateTriangleAtAnyScale) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    PlanarMesh mesh = Square();
    mesh.vertices.push_back({0.5, 1});
    mesh.triangles.push_back({3, 2, 4});  // on the top edge: no area
    for (Complex& p : mesh.vertices) p *= scale;
    const Fault fault = FaultOf(mesh);
    EXPECT_EQ(fault.kind, FaultKind::kDegenerateTriangle);
    EXPECT_THAT(fault.elements, ElementsAre(2));
  }
}

TEST(ValidationTest, NamesDuplicatesAndNonManifoldEdges) {
  PlanarMesh mesh = Square();
  mesh.triangles.push_back({2, 0, 1});
  EXPECT_EQ(FaultOf(mesh).kind, FaultKind::kDuplicateTriangle);
  EXPECT_THAT(FaultOf(mesh).elements, ElementsAre(0, 2));
  mesh = Square();
  mesh.vertices.push_back({2, 0.5});
  mesh.triangles.push_back({0, 4, 2});
  EXPECT_EQ(FaultOf(mesh).kind, FaultKind::kNonManifoldEdge);
  EXPECT_THAT(FaultOf(mesh).elements, ElementsAre(0, 1, 2));
}

TEST(ValidationTest, TurnsClockwiseTrianglesAndSaysSo) {
  PlanarMesh mesh = Square();
  std::swap(mesh.triangles[1][1], mesh.triangles[1][2]);
  const auto warnings = ValidatePlanar(mesh, {});
  ASSERT_TRUE(warnings.has_value());
  ASSERT_EQ(warnings->size(), 1u);
  EXPECT_EQ((*warnings)[0].kind, "reversed_triangles");
  EXPECT_THAT((*warnings)[0].elements, ElementsAre(1));
  EXPECT_EQ(mesh.triangles[1], (Triangle{0, 2, 3}));
}

TEST(ValidationTest, CountsUnreferencedVertices) {
  PlanarMesh mesh = Square();
  mesh.vertices.insert(mesh.vertices.begin(), Complex(7, 7));
  for (Triangle& t : mesh.triangles) {
    for (auto& v : t) ++v;
  }
  const auto warnings = ValidatePlanar(mesh, {});
  ASSERT_TRUE(warnings.has_value());
  ASSERT_EQ(warnings->size(), 1u);
  EXPECT_EQ((*warnings)[0].kind, "unreferenced_vertices");
  EXPECT_THAT((*warnings)[0].elements, ElementsAre(0));
}

TEST(ValidationTest, OrientsASurface) {
  SurfaceMesh cap = SphereCap(4, 8, 1.0);
  const auto good = cap.triangles;
  for (std::size_t t = 3; t < cap.triangles.size(); t += 5) {
    std::swap(cap.triangles[t][0], cap.triangles[t][1]);
  }
  const auto warnings = ValidateSurface(cap, {});
  ASSERT_TRUE(warnings.has_value());
  EXPECT_EQ((*warnings)[0].kind, "reversed_triangles");
  SurfaceMesh again = cap;
  EXPECT_TRUE(ValidateSurface(again, {})->empty());
}

TEST(ValidationTest, NamesAMoebiusStrip) {
  SurfaceMesh strip = MoebiusBand(12);
  const auto result = ValidateSurface(strip, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, FaultKind::kNotOrientable);
}

}  // namespace
}  // namespace arap::testing
