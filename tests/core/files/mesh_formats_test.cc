// One surface in every format, under right and wrong names, packed, and cut short.
#include <cstddef>

#include <gmock/gmock.h>

#include "core/files/bytes.h"
#include "core/files/formats.h"
#include "core/files/mesh_file.h"
#include "tests/support/folder.h"
#include "tests/support/mesh_bytes.h"

namespace arap {
namespace {

using ::testing::HasSubstr;
using testing::Polygons;

class EveryFormat : public FolderTest {
 protected:
  const Polygons tube_ = testing::QuarterTube(5, 2, 20, 10);
};

// STL has no vertices: they are numbered in the order in which the triangles name them.
SurfaceMesh AsNamed(const Polygons& mesh) {
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  SurfaceMesh named;
  std::vector<std::uint32_t> numbers(mesh.vertices.size(), kNone);
  for (Triangle t : testing::Fans(mesh)) {
    for (std::uint32_t& v : t) {
      if (numbers[v] == kNone) {
        numbers[v] = static_cast<std::uint32_t>(named.vertices.size());
        named.vertices.push_back(mesh.vertices[v]);
      }
      v = numbers[v];
    }
    named.triangles.push_back(t);
  }
  return named;
}

TEST_F(EveryFormat, HasOneMesh) {
  const SurfaceMesh mesh{tube_.vertices, testing::Fans(tube_)};
  for (const auto& [name, bytes] : testing::InEveryFormat(tube_)) {
    SCOPED_TRACE(name);
    const auto file = ReadSurfaceFile(Put(name, bytes));
    ASSERT_TRUE(file) << file.error().message;
    const bool stl = name.find(".stl") != std::string::npos;
    EXPECT_EQ(file->mesh, stl ? AsNamed(tube_) : mesh);
    const bool keeps_quads = !stl && name.find(".gl") == std::string::npos;
    EXPECT_EQ(file->face_count(), keeps_quads ? tube_.faces.size() : mesh.triangles.size());
    ASSERT_EQ(file->warnings.size(), stl ? 1u : 0u);
    if (!stl) continue;
    EXPECT_EQ(file->warnings[0].kind, "joined_corners");
    EXPECT_THAT(file->warnings[0].message, HasSubstr("60 corners, 18 vertices"));
  }
}

TEST_F(EveryFormat, GoesByTheContentBeforeTheName) {
  for (const auto& [name, bytes] : testing::InEveryFormat(tube_)) {
    if (name.find(".obj") != std::string::npos) continue;  // anything could be OBJ
    SCOPED_TRACE(name);
    const auto wrong = ReadSurfaceFile(Put("a.obj", bytes));
    ASSERT_TRUE(wrong) << wrong.error().message;
    EXPECT_EQ(wrong->warnings.front().kind, "other_format");
    EXPECT_THAT(wrong->warnings.front().message, HasSubstr("a.obj: the content is "));
    const auto nameless = ReadSurfaceFile(Put("a", bytes));
    ASSERT_TRUE(nameless) << nameless.error().message;
    EXPECT_EQ(nameless->mesh, wrong->mesh);
    EXPECT_EQ(nameless->warnings.size() + 1, wrong->warnings.size());
  }
}

// Files of which a part is missing are not read as smaller surfaces.
TEST_F(EveryFormat, IsRefusedWhereItEndsEarly) {
  const LoadBeside none = [](const std::string&, std::size_t) {
    return Fail(FaultKind::kNotFound, "nothing is beside it");
  };
  const Polygons small = testing::QuarterTube(2, 1, 20, 10);
  const std::string stl = testing::StlTextOf(small), bytes = testing::StlBytesOf(small, "solid");
  for (std::size_t size = 0; size + std::string("endsolid tube\n").size() < stl.size(); ++size) {
    EXPECT_FALSE(ParseStl(stl.substr(0, size), "a")) << size;
  }
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(ParseStl(bytes.substr(0, size), "a")) << size;
  }
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string ply = testing::PlyOf(small, format);
    const std::size_t last = format == std::string("ascii") ? 1 : 0;  // the end of its last line
    for (std::size_t size = 0; size + last < ply.size(); ++size) {
      EXPECT_FALSE(ParsePly(ply.substr(0, size), "a")) << format << size;
    }
  }
  for (const std::string& gltf : {testing::GltfOf(small), testing::GlbOf(small)}) {
    for (std::size_t size = 0; size < gltf.size(); ++size) {
      EXPECT_FALSE(ParseGltf(gltf.substr(0, size), "a", none)) << size;
    }
  }
  const std::string packed = testing::Packed(stl);
  for (std::size_t size = 0; size < packed.size(); ++size) {
    EXPECT_FALSE(Unpack(packed.substr(0, size), "a")) << size;
  }
}

TEST(Gzip, TakesPartsOneBehindTheOther) {
  const auto both =
      Unpack(testing::Packed("sol") + testing::Packed("") + testing::Packed("id"), "a");
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(*both, "solid");
  // More than is looked at in one go, and such that the last bytes fill it up.
  for (const std::size_t size : {std::size_t{65536}, std::size_t{200000}}) {
    std::string text;
    while (text.size() < size) text += std::to_string(text.size());
    text.resize(size);
    const auto long_one = Unpack(testing::Packed(text), "a");
    ASSERT_TRUE(long_one) << long_one.error().message;
    EXPECT_EQ(*long_one, text);
  }
}

TEST(Gzip, SaysWhatIsWrong) {
  const std::string packed = testing::Packed("solid");
  std::string damaged = packed;
  damaged[packed.size() - 6] ^= 1;  // of the check sum
  const std::string at_sum = std::to_string(packed.size() - 4);
  const std::pair<std::string, std::string> cases[] = {
      {damaged, "a.gz: byte " + at_sum + ": damaged data of gzip: incorrect data check"},
      {packed.substr(0, 12), "a.gz: byte 12: the file ends within data of gzip"},
      {packed + "xy", "a.gz: byte " + std::to_string(packed.size()) +
                          ": the file goes on for 2 bytes behind the data of gzip"},
      {std::string("\x1f\x8b\x07\0\0\0\0\0", 8),
       "a.gz: byte 4: damaged data of gzip: unknown compression method"},
  };
  for (const auto& [bytes, message] : cases) {
    const auto text = Unpack(bytes, "a.gz");
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error(), Fault(FaultKind::kInvalidOption, message));
  }
}

// A few bytes that stand for very many.
TEST_F(EveryFormat, IsRefusedAsABomb) {
  const auto allowed = Unpack(testing::Packed(std::string(70000, ' ')), "a.gz", 70000);
  ASSERT_TRUE(allowed);
  EXPECT_EQ(allowed->size(), 70000u);
  const auto refused = Unpack(testing::Packed(std::string(70001, ' ')), "a.gz", 70000);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr("bytes of gzip unpack to more than 70000, which is the limit"));
  // A part of 16 MiB over and over.
  const std::string part = testing::Packed(std::string(std::size_t{16} << 20U, ' '));
  std::string bomb;
  for (int k = 0; k < 17; ++k) bomb += part;
  const auto file = ReadSurfaceFile(Put("bomb.stl.gz", bomb));
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("bomb.stl.gz: "));
  EXPECT_THAT(file.error().message, HasSubstr("unpack to more than 268435456, which is the limit"));
  const auto twice = ReadSurfaceFile(Put("twice.obj.gz", testing::Packed(testing::Packed("v"))));
  ASSERT_FALSE(twice);
  EXPECT_THAT(twice.error().message, HasSubstr("twice.obj.gz: packed twice by gzip"));
}

TEST_F(EveryFormat, IsOneOfThese) {
  for (const char* bytes : {" ", "v 0 0 0\n", "MZ\x90", "<x3d/>"}) {
    const auto file = ReadSurfaceFile(Put("a.dat", bytes));
    ASSERT_FALSE(file) << bytes;
    EXPECT_THAT(file.error().message, HasSubstr("a.dat: not a mesh file"));
  }
}

}  // namespace
}  // namespace arap
