// First inputs for the targets that read files: as people and programs write them.
#include <string>

#include "tests/fuzz/seeds.h"
#include "tests/support/mesh_bytes.h"

namespace arap::fuzz {
namespace {

// Files that are no texts, or not alone.
void PutMeshBytes(const Seeds& seeds) {
  const testing::Polygons square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}, {{0, 1, 2, 3}}};
  seeds.Put("stl", "text", testing::StlTextOf(square) + "solid \nendsolid\n");
  seeds.Put("stl", "bytes", testing::StlBytesOf(square));
  seeds.Put("stl", "solid", testing::StlBytesOf(square, "solid a"));
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    seeds.Put("ply", format, testing::PlyOf(square, format));
  }
  seeds.Put(
      "ply", "extras",
      "ply\r\nformat ascii 1.0\r\nobj_info a\r\nelement face 1\r\nproperty list uint8 int32 "
      "vertex_index\r\nproperty uchar red\r\nelement vertex 3\r\nproperty short y\r\nproperty "
      "list char float w\r\nproperty int8 x\r\nproperty float64 z\r\nelement edge "
      "1\r\nproperty int v\r\nend_header\r\n3 0 1 2 9\r\n0 0 0 0\r\n1 1 7 0 0\r\n0 0 1 "
      "2.5\r\n4\r\n");
  seeds.Put("gltf", "json", testing::GltfOf(square));
  seeds.Put("gltf", "binary", testing::GlbOf(square));
  seeds.Put("gltf", "scene",
            R"({"asset":{"version":"2.1"},"extensionsRequired":["KHR_materials_unlit"],"nodes":[{)"
            R"("children":[1],"matrix":[0,1,0,0,-2,0,0,0,0,0,1,0,3,4,5,1]},{"mesh":0,"name":"a",)"
            R"("rotation":[0,0,1,1],"scale":[1,-1,2],"translation":[1,2,3],"skin":0},{"mesh":0}],)"
            R"("meshes":[{"primitives":[{"mode":4,"attributes":{"POSITION":0,"COLOR_0":0},)"
            R"("targets":[{}]},{"mode":1}]}],"accessors":[{"bufferView":0,"componentType":5126,)"
            R"("count":3,"type":"VEC3","byteOffset":4}],"bufferViews":[{"buffer":0,)"
            R"("byteLength":60,"byteStride":16}],"buffers":[{"byteLength":64,"uri":"a.bin"}]})");
  seeds.Put("gzip", "one", testing::Packed("solid"));
  seeds.Put("gzip", "parts", testing::Packed(std::string(5000, 'a')) + testing::Packed("b"));
}

}  // namespace

void PutTexts(const Seeds& seeds) {
  seeds.Put(
      "track_file", "plain",
      "{\"w\":1000,\"handles\":[{\"name\":\"a\",\"rest\":[0,10],\"triangle\":0,\"bary\":[0.5,0.5,0]"
      "},{\"rest\":[5,1],\"vertex\":3}],\"frames\":[{\"kind\":\"x\",\"targets\":[[0,10],null]},{"
      "\"targets\":[[0,1]],\"angles\":[0.5,null],\"scales\":[2]}],\"rigidity\":[1,2]}");
  seeds.Put("track_file", "edits",
            "{\"handles\":[{\"name\":\"a\",\"rest\":[0,0],\"hard\":true,\"depth\":1}],\"frames\":[{"
            "\"targets\":[null]},{\"targets\":[]}],\"edits\":[{\"frame\":1,\"remove\":[\"a\"],"
            "\"add\":[{\"name\":\"a\",\"rest\":[1,2],\"snap\":true}]}]}");
  seeds.Put("track_file", "wrong",
            "{\"handles\":[{\"rest\":[0,0]}],\r\n\"frames\":[{\"targets\":[[0,\"x\"]]}]}");
  seeds.Put("lists", "seams", "# back\n1 2 3\r\n4 5\r6 7 # end\n");
  seeds.Put("lists", "pins", "1 0 0\n2 1.5 -2e1 100\n");
  seeds.Put("lists", "rigidity", "1\n2\n3\n1e6\n");
  seeds.Put("lists", "json", "[1, 2, 3, 4]");
  seeds.Put("lists", "pairs", "[[0, 1], [2, 3]]");
  seeds.Put("lists", "long_lines", "1 2 3 4 5 6 7 8\n+1 1e-400 -.5 1\n");
  seeds.Put("lists", "report", "{\"cut_edges\": [[0, 1]], \"x\": {\"a\": [true, null, \"\\\"\"]}}");
}

void PutFiles(const Seeds& seeds) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  seeds.Put("obj", "triangles", square + "f 1 2 3\nf 1 3 4\n");
  seeds.Put("obj", "corners",
            square +
                "vt 0 0\nvn 0 0 1\nf 1/1 2/1 3/1\nf 1//1 3//1 4//1\nf -4/-1/-1 "
                "-3/1/1 -2/1/1\n");
  seeds.Put("obj", "polygons",
            square + "v 0.5 0.25\nf 1 2 3 4\nf 1 5 2 3 4\nf 1 2 2 3 4 1\nf 1 3 2 4\n");
  seeds.Put("obj", "parts",
            "# c\nmtllib a.mtl\no A\n" + square +
                "g a b\nusemtl m\ns 1\nf 1 2 3\no B\ng\nf 1 3 4\nl 1/1 2/1\n");
  seeds.Put("obj", "lines",
            "\xef\xbb\xbfv 0 \\\r\n 0\r\nv 1 0 # x\rv 1 1 0 1 v 0 1 0 1 0.5 0 vt 3 "
            "3 f 1 2 3\ncurv 1 \\\n2");
  seeds.Put("obj", "numbers", "v +1.5e3 -.5 1e-400\nv 1e999 0,5 nan\n");
  const std::string tail = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  seeds.Put("off", "triangles", "OFF\n4 2 0\n" + tail + "3 0 1 2\n3 0 2 3\n");
  seeds.Put("off", "polygon", "off4 1\n# c\n" + tail + "4 0 1 2 3 0.5 1 0\n");
  seeds.Put("off", "colours",
            "COFF 3 1 3\r\n0 0 0 9 9 9 9\r\n1 0 0 9 9 9 9\r0 1 0 9 9 9 9\n3 0 1 2 7");
  seeds.Put("off", "anywhere", "3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2");
  PutMeshBytes(seeds);
  seeds.Put("off", "claims", "OFF\n2000000000 1 0\n" + tail + "3000000000 0 1 2\n");
}

}  // namespace arap::fuzz
