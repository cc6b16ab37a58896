#include "core/files/mesh_file.h"

#include <gmock/gmock.h>

#include "core/files/formats.h"
#include "core/files/obj_writer.h"
#include "tests/support/folder.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class MeshFile : public FolderTest {};

// Out of order, with a vertex in the middle that no triangle uses.
constexpr const char* kObj =
    "# comment\nmtllib a.mtl\nv 0.1 0.30000000000000004 -1e-17\nv 5 5 5\nv 1 0 0\nv 0 1 0.5\n"
    "vt 0 0\nvt 1 0\nvn 0 0 1\n";

TEST_F(MeshFile, ObjKeepsOrderUnusedVerticesAndEveryBit) {
  const auto mesh = ReadSurfaceMesh(Put("a.obj", std::string(kObj) + "f 4/1/1 1/2/1 3/1/1\n"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_THAT(mesh->vertices, ElementsAre(Point3{0.1, 0.30000000000000004, -1e-17}, Point3{5, 5, 5},
                                          Point3{1, 0, 0}, Point3{0, 1, 0.5}));
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{3, 0, 2}));
}

TEST_F(MeshFile, OffKeepsOrderAndUnusedVertices) {
  const auto mesh = ReadSurfaceMesh(
      Put("a.OFF", "OFF\n4 1 0\n0.1 0.30000000000000004 3\n5 5 5\n1 0 0\n0 1 0\n3 3 0 2\n"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_THAT(mesh->vertices, ElementsAre(Point3{0.1, 0.30000000000000004, 3}, Point3{5, 5, 5},
                                          Point3{1, 0, 0}, Point3{0, 1, 0}));
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{3, 0, 2}));
}

TEST_F(MeshFile, WhatIsWrittenReadsBackExactly) {
  const SurfaceMesh mesh{{{0.1, 1.0 / 3, -2e-300}, {1e17, 0, 0}, {0, 1, 0}}, {{2, 0, 1}}};
  const auto back = ReadSurfaceMesh(Put("a.obj", FormatObj(mesh)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*back, mesh);
}

TEST_F(MeshFile, FlatPositionsAreWrittenPerCorner) {
  const SurfaceMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const std::vector<Complex> uv{{0, 0}, {0.5, 0}, {0, 0.25}};
  const std::vector<Triangle> corner_uv{{1, 2, 0}};
  EXPECT_EQ(FormatObj(mesh, uv, corner_uv),
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0.5 0\nvt 0 0.25\nf 1/2 2/3 3/1\n");
}

TEST_F(MeshFile, APlanarMeshDropsACommonZ) {
  const auto mesh = ReadPlanarMesh(Put("a.obj", "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_THAT(mesh->vertices, ElementsAre(Complex(0, 0), Complex(1, 0), Complex(0, 1)));
  const auto bent =
      ReadPlanarMesh(Put("b.obj", "v 0 0 2\nv 1 0 2\nv 0 1 2\nv 1 1 3\nf 1 2 3\nf 3 2 4\n"));
  ASSERT_FALSE(bent);
  EXPECT_THAT(bent.error().message, HasSubstr("b.obj: not in a plane: vertex "));
}

TEST_F(MeshFile, FaultsNameTheFile) {
  const auto bad = ReadSurfaceMesh(Put("bad.obj", "v 0 0 zero\n"));
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error(),
            Fault(FaultKind::kInvalidOption, Path("bad.obj") + ":1: 'zero' is not a number"));
  const auto unknown = ReadSurfaceMesh(Put("a.txt", "v 0 0 0\n"));
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, FaultKind::kInvalidOption);
  EXPECT_THAT(unknown.error().message, HasSubstr(".obj"));
  const auto missing = ReadSurfaceMesh(Path("missing.obj"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, FaultKind::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("missing.obj"));
}

// The same surface is the same mesh, whatever it was written in.
TEST(MeshFormats, HaveOneMeshForOneSurface) {
  const auto obj =
      ParseObj("v 0 0 0\nv 4 0 0.25\nv 4 3 0\nv 2 1 0\nv 0 3 1e-3\nf 3 4 5 1 2\n", "a");
  const auto off =
      ParseOff("OFF 5 1 0\n0 0 0\n4 0 0.25\n4 3 0\n2 1 0\n0 3 0.001\n5 2 3 4 0 1\n", "a");
  ASSERT_TRUE(obj) << obj.error().message;
  ASSERT_TRUE(off) << off.error().message;
  EXPECT_EQ(obj->mesh, off->mesh);
  EXPECT_EQ(obj->mesh.triangles.size(), 3u);
}

}  // namespace
}  // namespace arap
