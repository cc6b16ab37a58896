// What the reader of glTF makes of scenes, and of files that do not fit together.
#include <gmock/gmock.h>

#include "core/files/formats.h"
#include "core/files/mesh_file.h"
#include "tests/support/folder.h"
#include "tests/support/mesh_bytes.h"

namespace arap {
namespace {

using testing::BytesOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const LoadBeside kNothingBeside = [](const std::string& path, std::size_t) {
  return Fail(FaultKind::kNotFound, path + " is not there");
};

// Three vertices of a triangle, and a fourth one; their indices in bytes, halves and words.
std::string Buffer() {
  std::string bytes;
  for (const Point3& p : {Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{1, 1, 0.5}}) {
    for (const double x : p) bytes += BytesOf(static_cast<float>(x));
  }
  for (const std::uint32_t v : {0u, 1u, 2u, 2u, 1u, 3u}) bytes += BytesOf(v);
  for (const int v : {0, 1, 2}) bytes += BytesOf(static_cast<std::uint16_t>(v));
  return bytes + std::string("\2\1\3\0", 4);
}

// The parts of a file, to be changed one by one.
struct Parts {
  std::string asset = R"("asset":{"version":"2.0"})";
  std::string scenes = R"("scenes":[{"nodes":[0]}])";
  std::string nodes = R"([{"mesh":0}])";
  std::string meshes =
      R"([{"name":"square","primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";
  std::string accessors =
      R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"},)"
      R"({"bufferView":1,"byteOffset":24,"componentType":5123,"count":3,"type":"SCALAR"},)"
      R"({"bufferView":1,"byteOffset":30,"componentType":5121,"count":3,"type":"SCALAR"}])";
  std::string views =
      R"([{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":34}])";
  std::string buffers = R"([{"byteLength":82}])";
  std::string more;

  std::string Json() const {
    return "{" + asset + "," + scenes + R"(,"nodes":)" + nodes + R"(,"meshes":)" + meshes +
           R"(,"accessors":)" + accessors + R"(,"bufferViews":)" + views + R"(,"buffers":)" +
           buffers + more + "}";
  }
  Result<SurfaceFile> Read() const {
    return ParseGltf(testing::GlbOf(Json(), Buffer()), "a.glb", kNothingBeside);
  }
};

const std::vector<Triangle> kSquare{{0, 1, 2}, {2, 1, 3}};

TEST(Gltf, VerticesAndTrianglesKeepTheirOrder) {
  const auto file = Parts().Read();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.vertices,
              ElementsAre(Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{1, 1, 0.5}));
  EXPECT_EQ(file->mesh.triangles, kSquare);
  EXPECT_EQ(file->ObjectOf(0), "square");
  EXPECT_TRUE(file->warnings.empty());
  EXPECT_FALSE(file->has_extras);
}

TEST(Gltf, PartsThatShareVerticesGoOnSharingThem) {
  Parts parts;
  parts.meshes = R"([{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":2},)"
                 R"({"attributes":{"POSITION":0},"indices":3,"mode":4}]}])";
  const auto file = parts.Read();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.vertices.size(), 4u);
  EXPECT_EQ(file->mesh.triangles, kSquare);
  EXPECT_TRUE(file->has_extras);
}

TEST(Gltf, TrianglesWithoutIndicesAreThoseOfTheVertices) {
  Parts parts;
  parts.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}])";
  const auto file = parts.Read();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST(Gltf, VerticesMayLieApart) {
  Parts parts;  // every second one
  parts.views = R"([{"buffer":0,"byteLength":36,"byteStride":24},{"buffer":0,"byteLength":24}])";
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3"}])";
  parts.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
  EXPECT_THAT(parts.Read().error().message,
              HasSubstr("2 corners are no whole number of triangles"));
  parts.views = R"([{"buffer":0,"byteLength":48,"byteStride":16}])";
  parts.accessors = R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}])";
  const auto file = parts.Read();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.vertices, ElementsAre(Point3{0, 0, 0}, Point3{0, 0, 0}, Point3{0, 1, 1}));
}

// Positions as whole numbers, as they are or as parts of the largest one.
TEST(Gltf, PositionsMayBeShort) {
  struct Short {
    int component;
    const char* normalized;
    std::string bytes;  // of an entry
    Point3 point;
  };
  const auto half = [](int x) { return BytesOf(static_cast<std::int16_t>(x)); };
  const Short cases[] = {
      {5120, "false", std::string("\x7f\x81\x80\0", 4), {127, -127, -128}},
      {5120, "true", std::string("\x7f\x81\x80\0", 4), {1, -1, -1}},
      {5121, "false", std::string("\xff\x00\x33\0", 4), {255, 0, 51}},
      {5121, "true", std::string("\xff\x00\x33\0", 4), {1, 0, 0.2}},
      {5122, "false", half(32767) + half(-32768) + half(5) + half(0), {32767, -32768, 5}},
      {5122, "true", half(32767) + half(-32768) + half(0) + half(0), {1, -1, 0}},
      {5123, "false", half(-1) + half(1) + half(0) + half(0), {65535, 1, 0}},
      {5123, "true", half(-1) + half(0) + half(13107) + half(0), {1, 0, 0.2}},
  };
  for (const Short& each : cases) {
    Parts parts;
    const std::string size = std::to_string(each.bytes.size());
    const std::string three = std::to_string(3 * each.bytes.size());
    parts.more = R"(,"extensionsRequired":["KHR_mesh_quantization"])";
    parts.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
    parts.accessors = R"([{"bufferView":0,"count":3,"type":"VEC3","componentType":)" +
                      std::to_string(each.component) + R"(,"normalized":)" + each.normalized + "}]";
    parts.views = R"([{"buffer":0,"byteLength":)" + three + R"(,"byteStride":)" + size + "}]";
    parts.buffers = R"([{"byteLength":)" + three + "}]";
    const auto file = ParseGltf(testing::GlbOf(parts.Json(), each.bytes + each.bytes + each.bytes),
                                "a", kNothingBeside);
    ASSERT_TRUE(file) << file.error().message;
    for (const Point3& p : file->mesh.vertices) EXPECT_EQ(p, each.point) << each.component;
  }
}

// A node and where it puts the point (1, 0, 0), and whether it turns triangles over.
struct Placed {
  const char* nodes = nullptr;
  Point3 point{};
  bool mirrored = false;
};

TEST(Gltf, NodesPutMeshesWhereTheyBelong) {
  const Placed cases[] = {
      {R"([{"mesh":0,"translation":[1,2,3]}])", {2, 2, 3}},
      {R"([{"mesh":0,"scale":[2,3,4]}])", {2, 0, 0}},
      {R"([{"mesh":0,"scale":[-1,1,1]}])", {-1, 0, 0}, true},
      {R"([{"mesh":0,"scale":[-1,-1,1]}])", {-1, 0, 0}},
      // A quarter about z, and twice as long.
      {R"([{"mesh":0,"rotation":[0,0,2,2]}])", {0, 1, 0}},
      {R"([{"mesh":0,"translation":[5,0,0],"rotation":[0,0,1,1],"scale":[3,1,1]}])", {5, 3, 0}},
      {R"([{"mesh":0,"matrix":[0,2,0,0,-2,0,0,0,0,0,2,0,7,8,9,1]}])", {7, 10, 9}},
      {R"([{"translation":[0,5,0],"children":[1]},)"
       R"({"scale":[3,3,3],"children":[2]},{"mesh":0,"translation":[1,0,0]}])",
       {6, 5, 0}},
  };
  for (const Placed& each : cases) {
    Parts parts;
    parts.nodes = each.nodes;
    const auto file = parts.Read();
    ASSERT_TRUE(file) << each.nodes << file.error().message;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(file->mesh.vertices[1][k], each.point[k], 1e-15) << each.nodes;
    }
    EXPECT_EQ(file->mesh.triangles[0], (each.mirrored ? Triangle{0, 2, 1} : Triangle{0, 1, 2}));
  }
}

TEST(Gltf, AllMeshesOfTheSceneAreJoined) {
  Parts parts;
  parts.scenes = R"("scene":1,"scenes":[{"nodes":[3]},{"nodes":[2,0]}])";
  parts.nodes = R"([{"mesh":0,"name":"left"},{"mesh":0,"name":"low","translation":[0,0,-1]},)"
                R"({"children":[1],"mesh":0},{"mesh":1}])";
  parts.meshes = R"([{"name":"square","primitives":[{"attributes":{"POSITION":0},"indices":1}]},)"
                 R"({"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";
  const auto file = parts.Read();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.vertices.size(), 12u);
  EXPECT_EQ(file->mesh.triangles.size(), 6u);
  EXPECT_EQ(file->ObjectOf(0), "square");
  EXPECT_EQ(file->ObjectOf(2), "low");
  EXPECT_EQ(file->ObjectOf(4), "left");
  EXPECT_EQ(file->mesh.vertices[4], (Point3{0, 0, -1}));
  ASSERT_EQ(file->warnings.size(), 1u);
  EXPECT_EQ(file->warnings[0].message,
            "a.glb: meshes that the scene does not show are passed over (1 in all)");
  // Without scenes it is every node.
  parts.scenes = R"("scenes":[])";
  EXPECT_EQ(parts.Read()->mesh.triangles.size(), 8u);
}

TEST(Gltf, WhatIsPassedOverIsTold) {
  Parts parts;
  parts.nodes = R"([{"mesh":0,"skin":0,"translation":[9,9,9]}])";
  parts.meshes = R"([{"primitives":[{"mode":1,"attributes":{"POSITION":0}},)"
                 R"({"mode":0,"attributes":{"POSITION":0}},)"
                 R"({"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":0}]}]}])";
  parts.more = R"(,"extensionsRequired":["KHR_materials_unlit","KHR_texture_transform"])";
  const auto file = parts.Read();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.vertices[0], (Point3{0, 0, 0}));  // a skin stands where its bones are
  std::vector<std::string> told;
  for (const Warning& warning : file->warnings) told.push_back(warning.message);
  EXPECT_THAT(told,
              ElementsAre("a.glb: points and lines are passed over (2 in all)",
                          "a.glb: morph targets are passed over (1 in all)",
                          "a.glb: skins are passed over, and the meshes are as they were modelled "
                          "(1 in all)"));
}

// A part, what stands there instead, and what is said of it.
struct Wrong {
  std::string Parts::*part;
  const char* text;
  const char* message;
};

TEST(Gltf, FaultsNameThePlace) {
  const Wrong cases[] = {
      {&Parts::asset, R"("a":1)", "a.glb: glTF of version '': only version 2 is read"},
      {&Parts::asset, R"("asset":{"version":"1.0"})",
       "a.glb: glTF of version '1.0': only version 2 is read"},
      {&Parts::asset, "asset", "a.glb:1:2: not JSON: invalid literal; expected string literal"},
      {&Parts::more, R"(,"extensionsRequired":["KHR_draco_mesh_compression"])",
       "a.glb: extensionsRequired[0]: 'KHR_draco_mesh_compression' is not read"},
      {&Parts::scenes, R"("scene":0)", "a.glb: scene: there is no scenes[0], the file has 0"},
      {&Parts::scenes, R"("scenes":[{"nodes":[7]}])",
       "a.glb: scenes[0].nodes[0]: there is no nodes[7], the file has 1"},
      {&Parts::scenes, R"("scenes":[{}])",
       "a.glb: the scene shows no triangles; 0 parts are points or lines"},
      {&Parts::nodes, R"([{"mesh":0,"children":[0]}])",
       "a.glb: nodes[0]: it has two parents, or is above itself"},
      {&Parts::nodes, R"([{"mesh":3}])",
       "a.glb: nodes[0].mesh: there is no meshes[3], the file has 1"},
      {&Parts::nodes, R"([{"mesh":0.5}])", "a.glb: nodes[0].mesh: not a whole number of 0 or more"},
      {&Parts::nodes, R"([{"mesh":-1}])", "a.glb: nodes[0].mesh: not a whole number of 0 or more"},
      {&Parts::nodes, R"([{"mesh":0,"translation":[1,2]}])",
       "a.glb: nodes[0].translation: not a list of 3 numbers"},
      {&Parts::nodes, R"([{"mesh":0,"translation":[1,2,"3"]}])",
       "a.glb: nodes[0].translation[2]: not a number"},
      {&Parts::nodes, R"([{"mesh":0,"rotation":[0,0,0,0]}])",
       "a.glb: nodes[0]: the rotation is no quaternion"},
      {&Parts::nodes, R"([{"mesh":0,"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}])",
       "a.glb: nodes[0].matrix: the last row is not 0 0 0 1"},
      {&Parts::nodes, R"([{"mesh":0,"scale":[1e308,1,1],"translation":[1e308,0,0]}])",
       "a.glb: meshes[0].primitives[0].attributes.POSITION: vertex 1 is not finite where its node "
       "puts it"},
      {&Parts::nodes, R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}}])",
       "a.glb: nodes[0].extensions.EXT_mesh_gpu_instancing: instances are not read"},
      {&Parts::meshes, R"([{"primitives":[{"mode":5,"attributes":{"POSITION":0}}]}])",
       "a.glb: meshes[0].primitives[0]: strips and fans are not read"},
      {&Parts::meshes, R"([{"primitives":[{"attributes":{"NORMAL":0}}]}])",
       "a.glb: meshes[0].primitives[0]: the POSITION of the vertices is missing"},
      {&Parts::meshes, R"([{"primitives":[{"attributes":{"POSITION":9}}]}])",
       "a.glb: meshes[0].primitives[0].attributes.POSITION: there is no accessors[9], the file has "
       "4"},
      {&Parts::meshes, R"([{"primitives":[{"attributes":{"POSITION":1}}]}])",
       "a.glb: accessors[1]: the type 'SCALAR' does not fit here"},
      {&Parts::meshes, R"([{"primitives":[{"attributes":{"POSITION":0}}]}])",
       "a.glb: meshes[0].primitives[0]: 4 corners are no whole number of triangles"},
      {&Parts::accessors,
       R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
       R"({"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"}])",
       "a.glb: meshes[0].primitives[0].indices: entry 5 is vertex 3, there are 3"},
      {&Parts::accessors,
       R"([{"bufferView":0,"componentType":5126,"count":2000000000,"type":"VEC3"}])",
       "a.glb: accessors[0]: 2000000000 entries of 12 bytes from byte 0 on; its bufferView has 48 "
       "bytes"},
      {&Parts::accessors,
       R"([{"bufferView":0,"componentType":5126,"count":1,"type":"VEC3","byteOffset":9007199254740991}])",
       "a.glb: accessors[0]: 1 entries of 12 bytes from byte 9007199254740991 on; its bufferView "
       "has "
       "48 bytes"},
      {&Parts::accessors, R"([{"componentType":5126,"count":3,"type":"VEC3"}])",
       "a.glb: accessors[0]: without a bufferView: compressed data are not read"},
      {&Parts::accessors,
       R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{}}])",
       "a.glb: accessors[0]: sparse accessors are not read"},
      {&Parts::accessors, R"([{"bufferView":0,"componentType":5125,"count":3,"type":"VEC3"}])",
       "a.glb: meshes[0].primitives[0].attributes.POSITION: positions have to be floats or short "
       "whole numbers"},
      {&Parts::accessors, R"([{"bufferView":0,"componentType":5124,"count":3,"type":"VEC3"}])",
       "a.glb: accessors[0]: there is no such componentType"},
      {&Parts::accessors,
       R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
       R"({"bufferView":1,"componentType":5126,"count":6,"type":"SCALAR"}])",
       "a.glb: meshes[0].primitives[0].indices: indices have to be unsigned"},
      {&Parts::views, R"([{"buffer":0,"byteOffset":40,"byteLength":48}])",
       "a.glb: bufferViews[0]: 48 bytes from byte 40 on; the buffer has 82"},
      {&Parts::views, R"([{"buffer":0,"byteLength":48,"byteStride":4}])",
       "a.glb: bufferViews[0]: the byteStride is shorter than an entry"},
      {&Parts::buffers, R"([{"byteLength":9000}])",
       "a.glb: buffers[0]: it claims 9000 bytes, there are 84"},
      {&Parts::buffers, R"([{"byteLength":82,"uri":"data:;base64,A*AA"}])",
       "a.glb: buffers[0].uri: the data are not in base 64"},
      {&Parts::buffers, R"([{"byteLength":82,"uri":"../a.bin"}])",
       "a.glb: buffers[0].uri: '../a.bin' is no file in the folder of this one"},
      {&Parts::buffers, R"([{"byteLength":82,"uri":"%2Fetc/passwd"}])",
       "a.glb: buffers[0].uri: '%2Fetc/passwd' is no file in the folder of this one"},
      {&Parts::buffers, R"([{"byteLength":82,"uri":"http://a/b"}])",
       "a.glb: buffers[0].uri: 'http://a/b' is no file in the folder of this one"},
      {&Parts::buffers, R"([{"byteLength":82,"uri":"no%20such.bin"}])", "no such.bin is not there"},
  };
  for (const Wrong& each : cases) {
    Parts parts;
    parts.*each.part = each.text;
    const auto file = parts.Read();
    ASSERT_FALSE(file) << each.message;
    EXPECT_EQ(file.error().message, each.message);
  }
}

TEST(Gltf, TheContainerHasToFit) {
  const std::string glb = testing::GlbOf(Parts().Json(), Buffer());
  const auto with = [&glb](std::size_t at, std::uint32_t number) {
    std::string changed = glb;
    return changed.replace(at, 4, BytesOf(number));
  };
  const std::string size = std::to_string(glb.size());
  const std::pair<std::string, std::string> cases[] = {
      {with(4, 1), "a: byte 4: GLB of version 1: only version 2 is read"},
      {with(8, 4000000000), "a: byte 8: the header claims 4000000000 bytes, the file has " + size},
      {glb + "    ", "a: byte 8: the header claims " + size + " bytes, the file has " +
                         std::to_string(glb.size() + 4)},
      {with(12, 4000000000), "a: byte 12: a chunk claims 4000000000 bytes, the file has " +
                                 std::to_string(glb.size() - 20) + " more"},
      {with(16, 0), "a: byte 16: the first chunk is JSON, and no other one"},
      {std::string("glTF\2\0\0\0\x0c\0\0\0", 12), "a:1:1: not JSON: unexpected end of input"},
  };
  for (const auto& [bytes, message] : cases) {
    const auto file = ParseGltf(bytes, "a", kNothingBeside);
    ASSERT_FALSE(file) << message;
    EXPECT_THAT(file.error().message, HasSubstr(message));
  }
}

// Few bytes that stand for very many triangles, or values.
TEST(Gltf, RepeatingAMeshHasALimit) {
  Parts parts;
  std::string nodes, roots, parts_list;
  for (int k = 0; k < 2000; ++k) {
    nodes += std::string(k > 0 ? "," : "") + R"({"mesh":0})";
    roots += (k > 0 ? "," : "") + std::to_string(k);
  }
  for (int k = 0; k < 2000; ++k) {
    parts_list += std::string(k > 0 ? "," : "") + R"({"attributes":{"POSITION":0},"indices":1})";
  }
  parts.nodes = "[" + nodes + "]";
  parts.scenes = R"("scenes":[{"nodes":[)" + roots + "]}]";
  const auto allowed = parts.Read();
  ASSERT_TRUE(allowed) << allowed.error().message;
  EXPECT_EQ(allowed->face_count(), 4000u);
  parts.meshes = R"([{"primitives":[)" + parts_list + "]}]";
  const auto refused = parts.Read();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("which is too much for a file of "));

  std::string many = R"(,"extras":[0)";
  for (int k = 0; k < 400000; ++k) many += ",[]";
  Parts wide;
  wide.more = many + "]";
  EXPECT_THAT(wide.Read().error().message, HasSubstr("so many short values take too much memory"));
  Parts deep;
  deep.more = R"(,"extras":)" + std::string(200000, '[') + std::string(200000, ']');
  EXPECT_THAT(deep.Read().error().message, HasSubstr("nested too deeply"));
}

class GltfFiles : public FolderTest {};

TEST_F(GltfFiles, BuffersMayLieBesideThem) {
  Parts parts;
  parts.buffers = R"([{"byteLength":82,"uri":"the%20buffer.bin"}])";
  Put("a.gltf", parts.Json());
  EXPECT_EQ(ReadSurfaceFile(Path("a.gltf")).error().kind, FaultKind::kNotFound);
  Put("the buffer.bin", Buffer());
  const auto file = ReadSurfaceFile(Path("a.gltf"));
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.triangles, kSquare);
  Put("the buffer.bin", "short");
  EXPECT_THAT(ReadSurfaceFile(Path("a.gltf")).error().message,
              HasSubstr("the buffer.bin: " + Path("a.gltf") + " wants 82 bytes of it, it has 5"));
}

}  // namespace
}  // namespace arap
