// What reading a file takes is bounded by its length, whatever it claims and however it is made. Each
// is read by a process of its own, whose largest size is taken. (Of a packed file it is the length of
// what was packed.)
#include <cmath>
#include <csignal>
#include <functional>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/cli/commands/flatten_inputs.h"
#include "core/files/mesh_file.h"
#include "core/files/text_file.h"
#include "core/files/track_file.h"
#include "tests/support/folder.h"
#include "tests/support/mesh_bytes.h"

namespace arap::cli {
namespace {

using arap::testing::BytesOf;

constexpr std::size_t kSize = 20'000'000;  // of a file that is as long as one likes
constexpr std::size_t kFixed = std::size_t{64} << 20U, kPerByte = 20;

// As often as it fits.
std::string Fill(const std::string& unit, std::size_t size = kSize) {
  std::string text;
  text.reserve(size);
  while (text.size() + unit.size() <= size) text += unit;
  return text;
}

// A list in brackets.
std::string List(const std::string& element, std::size_t size = kSize) {
  std::string text = "[" + Fill(element + ",", size);
  text.back() = ']';
  return text;
}

constexpr const char* kCorners = "v 0 0\nv 1 0\nv 0 1\n";

// A face of so many corners on a circle, every second of them further out by `notch`.
std::string Wheel(int corners, double notch) {
  std::string text, face = "f";
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, r = i % 2 == 0 ? 1 + notch : 1;
    text += fmt::format("v {} {}\n", r * std::cos(angle), r * std::sin(angle));
    face += fmt::format(" {}", i + 1);
  }
  return text + face + "\n";
}

std::string Track(const std::string& handles, const std::string& frames,
                  const std::string& edits = "[]") {
  return R"({"handles":)" + handles + R"(,"frames":)" + frames + R"(,"edits":)" + edits + "}";
}

// Each of so many edits takes another handle away.
std::string ManyEdits(int count) {
  std::string edits = "[";
  for (int i = 0; i < count; ++i) {
    edits += fmt::format("{{\"frame\":{},\"remove\":[\"h{}\"]}},", i, i);
  }
  edits.back() = ']';
  return Track(List("{\"rest\":[0,0]}", static_cast<std::size_t>(count) * 15),
               List("{\"targets\":[]}", static_cast<std::size_t>(count) * 15), edits);
}

// A binary STL file of as many triangles as fit, no two with a corner in common.
std::string Facets() {
  constexpr std::size_t kFacet = 50;
  std::string bytes(80, ' ');
  bytes.reserve(kSize);
  const std::size_t count = (kSize - 84) / kFacet;
  bytes += BytesOf(static_cast<std::uint32_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    bytes.append(12, '\0');
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (const std::size_t x : {i, corner, corner * corner}) {
        bytes += BytesOf(static_cast<float>(x));
      }
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

// A PLY file of bytes: so many vertices at 0, so many faces, and what these are.
std::string Ply(std::size_t vertices, std::size_t faces, const std::string& body) {
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty uchar x\n"
             "property uchar y\nproperty uchar z\nelement face {}\n"
             "property list uchar uchar vertex_index\nend_header\n",
             vertices, faces) +
         std::string(3 * vertices, '\0') + body;
}

// A GLB file of a mesh of so many triangles of 256 vertices, with corners of a component type.
std::string Glb(std::size_t triangles, int component, const std::string& scene,
                const std::string& more = "") {
  const std::size_t size = component == 5121 ? 1 : 2;
  std::string corner(size, '\0'), buffer(256 * 12, '\0');
  for (std::size_t k = 0; k < 3 * triangles; ++k) {
    corner[0] = static_cast<char>(k);
    buffer += corner;
  }
  const std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},{},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},)"
      R"("indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":256,)"
      R"("type":"VEC3"}},{{"bufferView":1,"componentType":{},"count":{},"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":3072}},{{"buffer":0,"byteOffset":3072,)"
      R"("byteLength":{}}}],"buffers":[{{"byteLength":{}}}]{}}})",
      scene, component, 3 * triangles, 3 * triangles * size, buffer.size(), more);
  return arap::testing::GlbOf(json, buffer);
}

constexpr const char* kOneNode = R"("nodes":[{"mesh":0}])";

// So many nodes that all show the mesh.
std::string Nodes(std::size_t count) {
  constexpr std::size_t kNode = 11;  // with its comma
  return R"("nodes":)" + List(R"({"mesh":0})", 1 + kNode * count);
}

// Whether it can be read.
using Read = bool (*)(const std::string& path);

bool ReadMesh(const std::string& path) { return ReadSurfaceFile(path).has_value(); }
bool ReadATrack(const std::string& path) { return ReadTrack(path).has_value(); }
// As flatten does.
template <class Parse>
bool ReadList(const std::string& path, const Parse& parse) {
  const auto text = ReadTextFile(path);
  return text && parse(*text).has_value();
}
bool ReadSeams(const std::string& path) {
  return ReadList(path, [](const auto& text) { return ParseSeams(text, "seams", 9); });
}
bool ReadPins(const std::string& path) {
  return ReadList(path, [](const auto& text) { return ParsePins(text, "pins", 9); });
}
bool ReadRigidity(const std::string& path) {
  return ReadList(path, [](const auto& text) { return ParseRigidity(text, "rigidity", 9); });
}

struct Case {
  const char* name;
  const char* file;
  Read read;
  std::function<std::string()> text;
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

std::vector<Case> Cases() {
  const auto fill = [](const char* unit) { return [unit] { return Fill(unit); }; };
  const auto behind = [](std::string head, const char* unit) {
    return [head, unit] { return head + Fill(unit); };
  };
  const auto list = [](const char* element) { return [element] { return List(element); }; };
  // Frames of so many handles; what is much larger is refused.
  const auto frames = [](std::size_t handles, const char* frame, std::size_t size) {
    return [=] { return Track(List("{\"rest\":[0,0]}", 16 * handles), List(frame, size)); };
  };
  std::vector<Case> cases{
      {"obj_keywords", "a.obj", ReadMesh, fill("v\n")},
      {"obj_keywords_on_a_line", "a.obj", ReadMesh, fill("v ")},
      {"obj_faces_on_a_line", "a.obj", ReadMesh, fill("f ")},
      {"obj_vertices", "a.obj", ReadMesh, behind("f 1 2 3\n", "v 1 1\n")},
      {"obj_triangles", "a.obj", ReadMesh, behind(kCorners, "f 1 2 3\n")},
      {"obj_corners", "a.obj", ReadMesh, behind(std::string(kCorners) + "f", " 1 2 3")},
      {"obj_parts", "a.obj", ReadMesh, behind(kCorners, "o a\ng b\nf 1 2 3\no c\n")},
      {"obj_newlines", "a.obj", ReadMesh, fill("\n")},
      {"obj_joined_lines", "a.obj", ReadMesh, behind(std::string(kCorners) + "f 1 2 3", "\\\n")},
      {"obj_one_word", "a.obj", ReadMesh, fill("x")},
      {"obj_one_number", "a.obj", ReadMesh, behind("v ", "1")},
      {"obj_one_name", "a.obj", ReadMesh, behind(std::string(kCorners) + "f 1 2 3\ng ", "n")},
      {"obj_unknown", "a.obj", ReadMesh, behind(std::string(kCorners) + "f 1 2 3\n", "a b\n")},
      {"obj_nothing", "a.obj", ReadMesh, [] { return std::string(kSize, '\0'); }},
      {"obj_convex_polygon", "a.obj", ReadMesh, [] { return Wheel(100'000, 0); }},
      {"obj_concave_polygon", "a.obj", ReadMesh, [] { return Wheel(100'000, 0.5); }},
      {"off_two_billion", "a.off", ReadMesh,
       [] { return "OFF\n2000000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"; }},
      {"off_face_of_three_billion", "a.off", ReadMesh,
       [] { return "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3000000000 0 1 2\n"; }},
      {"off_all_that_has_room", "a.off", ReadMesh, behind("OFF 3333332 2499999\n", "0 ")},
      {"off_vertices", "a.off", ReadMesh, behind("OFF 3333320 1\n", "0 0 0\n")},
      {"off_one_polygon", "a.off", ReadMesh,
       behind("OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n9999999", " 0 1 2")},
      {"off_newlines", "a.off", ReadMesh, fill("\n")},
      {"off_one_word", "a.off", ReadMesh, behind("OFF", "9")},
      {"stl_text", "a.stl", ReadMesh,
       [] {
         return "solid\n" +
                Fill("facet outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet ") +
                "endsolid\n";
       }},
      {"stl_solids", "a.stl", ReadMesh, fill("solid\nendsolid\n")},
      {"stl_one_name", "a.stl", ReadMesh, behind("solid ", "n")},
      {"stl_facets", "a.stl", ReadMesh, Facets},
      {"ply_vertices", "a.ply", ReadMesh,
       [] { return Ply(kSize / 3, 1, std::string("\3\0\1\2", 4)); }},
      {"ply_faces", "a.ply", ReadMesh,
       [] { return Ply(3, kSize / 4, Fill(std::string("\3\0\1\2", 4))); }},
      {"ply_two_billion", "a.ply", ReadMesh, [] { return Ply(2, 2'000'000'000, "\3"); }},
      {"ply_properties", "a.ply", ReadMesh,
       behind("ply\nformat ascii 1.0\nelement vertex 9\n", "property int a\n")},
      {"ply_comments", "a.ply", ReadMesh, behind("ply\nformat ascii 1.0\n", "comment\n")},
      {"glb_corners_of_a_byte", "a.glb", ReadMesh, [] { return Glb(kSize / 3, 5121, kOneNode); }},
      {"glb_corners", "a.glb", ReadMesh, [] { return Glb(kSize / 6, 5123, kOneNode); }},
      {"glb_repeated_mesh", "a.glb", ReadMesh, [] { return Glb(2'000, 5123, Nodes(3'000)); }},
      {"glb_repeated_much", "a.glb", ReadMesh,
       [] {
         return Glb(
             2'000, 5123, Nodes(3'000),
             R"(,"extras":)" + List("123", kSize / 2) + R"(,"a":")" + Fill("a", kSize / 2) + '"');
       }},
      {"gltf_values", "a.gltf", ReadMesh, list("0")},
      {"gltf_lists", "a.gltf", ReadMesh, list("[]")},
      {"gltf_nodes", "a.gltf", ReadMesh,
       [] { return R"({"asset":{"version":"2.0"},"nodes":)" + List("{}", 1'000'000) + "}"; }},
      {"gltf_strings", "a.gltf", ReadMesh, list("\"\"")},
      {"gltf_buffer", "a.gltf", ReadMesh,
       [] {
         return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":)"
                R"([{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,)"
                R"("componentType":5126,"count":1249998,"type":"VEC3"}],"bufferViews":)"
                R"([{"buffer":0,"byteLength":14999976}],"buffers":[{"byteLength":15000000,)"
                R"("uri":"data:;base64,)" +
                Fill("A") + R"("}]})";
       }},
      {"seams_on_a_line", "s", ReadSeams, fill("1 2 ")},
      {"seams_lines", "s", ReadSeams, fill("1 2\n")},
      {"seams_one_word", "s", ReadSeams, fill("1")},
      {"seams_json", "s", ReadSeams, list("0,1")},
      {"seams_json_pairs", "s", ReadSeams, list("[0,1]")},
      {"seams_json_strings", "s", ReadSeams, list("\"\"")},
      {"pins", "p", ReadPins, fill("1 1 1\n")},
      {"pins_on_a_line", "p", ReadPins, fill("1 ")},
      {"rigidity", "r", ReadRigidity, fill("1\n")},
      {"rigidity_json", "r", ReadRigidity, list("1")},
      {"rigidity_json_lists", "r", ReadRigidity, list("[]")},
      {"track_deep", "t", ReadATrack, fill("[")},
      {"track_objects", "t", ReadATrack, list("{}")},
      {"track_members", "t", ReadATrack, [] { return "{" + Fill("\"a\":0,") + "\"b\":0}"; }},
      {"track_string", "t", ReadATrack, [] { return "\"" + Fill("a") + "\""; }},
      {"track_handles", "t", ReadATrack, [] { return Track(List("{\"rest\":[0,0]}"), "[]"); }},
      {"track_frames", "t", ReadATrack, frames(1, "{\"targets\":[]}", 7'000'000)},
      {"track_targets", "t", ReadATrack,
       frames(6, "{\"targets\":[[10,0],[10,0],[10,0],[10,0],[10,0],[10,0]]}", 12'000'000)},
      {"track_frames_of_brackets", "t", ReadATrack, frames(6, "{\"targets\":[[0,0],[]]}", kSize)},
      {"track_nulls", "t", ReadATrack,
       frames(6, "{\"targets\":[null,null,null,null,null,null]}", kSize)},
      {"track_one_frame", "t", ReadATrack, [] { return Track("[]", List("[0,0]")); }},
      {"track_edits", "t", ReadATrack, [] { return ManyEdits(100'000); }},
  };
  return cases;
}

struct Taken {
  std::size_t bytes = 0;
  bool read = false;
};

std::size_t LargestSize() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

// What reading takes in a process that has nothing else to do.
Taken TakenBy(const Case& one, const std::string& path) {
  int ends[2] = {};
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // A reader without a bound ends here and not the machine.
    const rlimit most{std::size_t{4} << 30U, std::size_t{4} << 30U};
    setrlimit(RLIMIT_AS, &most);
    const std::size_t before = LargestSize();
    Taken taken;
    taken.read = one.read(path);
    taken.bytes = LargestSize() - before;
    _exit(write(ends[1], &taken, sizeof(taken)) == sizeof(taken) ? 0 : 1);
  }
  close(ends[1]);
  Taken taken;
  EXPECT_EQ(read(ends[0], &taken, sizeof(taken)), static_cast<ssize_t>(sizeof(taken)))
      << "the reader was ended";
  close(ends[0]);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return taken;
}

class ReaderMemory : public FolderTest, public ::testing::WithParamInterface<Case> {};

TEST_P(ReaderMemory, IsBoundedByTheFile) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  std::string text = GetParam().text();
  const std::size_t size = text.size();
  const std::string path = Put(GetParam().file, text);
  text = {};
  const Taken taken = TakenBy(GetParam(), path);
  RecordProperty("bytes", fmt::to_string(taken.bytes));
  RecordProperty("size", fmt::to_string(size));
  EXPECT_LE(taken.bytes, kFixed + kPerByte * size) << (taken.read ? "read" : "refused");
}

INSTANTIATE_TEST_SUITE_P(Files, ReaderMemory, ::testing::ValuesIn(Cases()),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace arap::cli
