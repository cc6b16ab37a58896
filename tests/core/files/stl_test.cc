// What the reader of STL makes of files as programs write them, and of damaged ones.
#include <limits>

#include <gmock/gmock.h>

#include "core/files/formats.h"
#include "tests/support/mesh_bytes.h"

namespace arap {
namespace {

using testing::BytesOf;
using ::testing::ElementsAre;

std::string Facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c +
         "\nendloop\nendfacet\n";
}
std::string Solid(const std::string& facets, const std::string& name = "a") {
  return "solid " + name + "\n" + facets + "endsolid " + name + "\n";
}
const std::string kFirst = Facet("0 0 0", "1 0 0", "1 1 0");
const std::string kSecond = Facet("0 0 0", "1 1 0", "0 1 0.5");

struct Written {
  const char* name;
  std::string text;
};
std::ostream& operator<<(std::ostream& out, const Written& written) { return out << written.name; }

std::string Replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) {
    text.replace(at, what.size(), with);
  }
  return text;
}

class StlTexts : public ::testing::TestWithParam<Written> {};

TEST_P(StlTexts, AreTheSquare) {
  const auto file = ParseStl(GetParam().text, "a.stl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.vertices,
              ElementsAre(Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{1, 1, 0}, Point3{0, 1, 0.5}));
  EXPECT_THAT(file->mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  ASSERT_EQ(file->warnings.size(), 1u);
  EXPECT_EQ(file->warnings[0].kind, "joined_corners");
  EXPECT_EQ(file->warnings[0].count, 2u);
}

const std::string kSquare = Solid(kFirst + kSecond);

INSTANTIATE_TEST_SUITE_P(
    Written, StlTexts,
    ::testing::Values(
        Written{"plain", kSquare}, Written{"crlf", Replaced(kSquare, "\n", "\r\n")},
        Written{"cr", Replaced(kSquare, "\n", "\r")},
        Written{"indented", Replaced(kSquare, "\n", "\n \t ")},
        Written{"blank_lines", "\n\n" + Replaced(kSquare, "\n", "\n\n")},
        Written{"byte_order_mark", "\xef\xbb\xbf" + kSquare},
        Written{"upper_case", Replaced(Replaced(kSquare, "facet", "FACET"), "solid", "SOLID")},
        Written{"no_name", Solid(kFirst + kSecond, "")},
        Written{"name_of_keywords", Solid(kFirst + kSecond, "facet normal endsolid")},
        Written{"no_normals", Replaced(kSquare, " normal 0 0 1", "")},
        Written{"broken_normals", Replaced(kSquare, "normal 0 0 1", "normal nan -nan(ind) 1,5")},
        Written{"one_line", "solid a\n" + Replaced(kFirst + kSecond, "\n", " ") + "endsolid"},
        Written{"exponents", Replaced(kSquare, "vertex 1", "vertex +1.0E+000")},
        Written{"minus_zero", Replaced(kSquare, "1 0 0", "1 -0.0 0")},
        Written{"two_solids", Solid(kFirst, "one") + Solid(kSecond, "two")}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(Stl, SolidsAreObjects) {
  const auto file =
      ParseStl(Solid(kFirst, "front side") + Solid("", "none") + Solid(kSecond, "back"), "a");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->ObjectOf(0), "front side");
  EXPECT_EQ(file->ObjectOf(1), "back");
  EXPECT_THAT(file->face_lines, ElementsAre(2u, 13u));
}

// The two triangles of the square, and what becomes of some of their bytes.
testing::Polygons Square() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}}, {{0, 1, 2, 3}}};
}

TEST(Stl, BytesThatBeginWithSolidAreBytes) {
  for (const char* header : {"", "solid a", "solid\nfacet normal", "COLOR=\xff\x10\x20\xff"}) {
    const auto file = ParseStl(testing::StlBytesOf(Square(), header), "a");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->mesh, ParseStl(kSquare, "a")->mesh);
    EXPECT_EQ(file->face_count(), 2u);
    EXPECT_TRUE(file->face_lines.empty());
  }
}

TEST(Stl, EmptyTrianglesAreLeftOut) {
  const auto file = ParseStl(Solid(kFirst + Facet("5 0 0", "5 0 0", "1 1 0") + kSecond), "a.stl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh, ParseStl(kSquare, "a")->mesh);
  ASSERT_EQ(file->warnings.size(), 2u);
  EXPECT_EQ(file->warnings[0].message,
            "a.stl:9: a triangle with two equal corners is left out (1 in all)");
  EXPECT_EQ(file->PlaceOf("a.stl", 1), "a.stl:16");
  // Those that stay keep their numbers.
  const testing::Polygons pair{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 0, 1}, {0, 1, 2}}};
  const auto bytes = ParseStl(testing::StlBytesOf(pair), "b.stl");
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_EQ(bytes->warnings[0].message,
            "b.stl: face 0: a triangle with two equal corners is left out (1 in all)");
  EXPECT_EQ(bytes->PlaceOf("b.stl", 0), "b.stl: face 1");
}

TEST(Stl, FaultsNameThePlace) {
  const std::string bytes = testing::StlBytesOf(Square(), "solid");
  std::string nan = bytes, more = bytes, fewer = bytes;
  const auto put = [](std::string& to, std::size_t at, const std::string& what) {
    to.replace(at, what.size(), what);
  };
  put(nan, 84 + 50 + 12 + 4, BytesOf(std::numeric_limits<float>::quiet_NaN()));
  put(more, 80, BytesOf(std::uint32_t{2000000000}));
  put(fewer, 80, BytesOf(std::uint32_t{1}));
  const std::pair<std::string, const char*> cases[] = {
      {"",
       "a: not STL: a text begins with 'solid', and the binary form has 84 bytes at least, "
       "not 0"},
      {nan, "a: byte 150: nan is not a finite number"},
      {more, "a: byte 80: the header claims 2000000000 triangles, the file has room for 2"},
      {fewer,
       "a: byte 134: the file goes on for 50 bytes behind the 1 triangles that the header claims"},
      {bytes + '\n',
       "a: byte 184: the file goes on for 1 bytes behind the 2 triangles that the "
       "header claims"},
      {testing::StlBytesOf({}), "a: no triangles with three different corners, 0 others"},
      {Solid(""), "a: no triangles with three different corners, 0 others"},
      {Solid(Facet("1 1 1", "1 1 1", "0 0 0")),
       "a: no triangles with three different corners, 1 others"},
      {Solid(Facet("0 0 0", "1 0 zero", "1 1 0")), "a:5: 'zero' is not a number"},
      {Solid(Facet("0 0 0", "1 0 0,5", "1 1 0")), "a:5: '0,5' is not a number (decimal comma?)"},
      {Solid(Facet("0 0 0", "inf 0 0", "1 1 0")), "a:5: 'inf' is not a finite number"},
      {Solid(Facet("0 0 0", "1e999 0 0", "1 1 0")), "a:5: '1e999' is too large for a number"},
      {Solid(Facet("0 0 0", "1 0", "1 1 0")), "a:6: 'vertex' is not a number"},
      {Solid(Facet("0 0 0", "1 0 0 7", "1 1 0")), "a:5: '7': 'vertex' is wanted"},
      {Solid(Replaced(kFirst, "endloop", "vertex 0 0 0\nendloop")),
       "a:7: 'vertex': 'endloop' is wanted"},
      {Solid(Replaced(kFirst, "vertex 1 1 0\n", "")), "a:6: 'endloop': 'vertex' is wanted"},
      {"solid a\n" + kFirst, "a:9: the text ends within a solid: 'facet' or 'endsolid' is wanted"},
      {kSquare + "3 0 1 2\n", "a:17: '3': 'solid' is wanted"},
  };
  for (const auto& [text, message] : cases) {
    const auto file = ParseStl(text, "a");
    ASSERT_FALSE(file) << message;
    EXPECT_EQ(file.error(), Fault(FaultKind::kInvalidOption, message));
  }
}

}  // namespace
}  // namespace arap
