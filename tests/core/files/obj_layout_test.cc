#include <gmock/gmock.h>

#include "core/files/formats.h"
#include "core/files/obj_writer.h"

namespace arap {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// The text with a layout whose vertices lie at (index, 0.5), but for the corners that are moved to
// another place first.
std::string LaidOut(const std::string& text,
                    const std::vector<std::pair<std::size_t, std::size_t>>& moved = {},
                    std::vector<Warning>* told = nullptr) {
  const auto file = ParseObj(text, "a");
  if (!file) return file.error().message;
  std::vector<Complex> uv;
  for (std::size_t v = 0; v < file->mesh.vertices.size(); ++v) {
    uv.emplace_back(static_cast<double>(v), 0.5);
  }
  std::vector<Triangle> corner_uv = file->mesh.triangles;
  for (const auto& [triangle, corner] : moved) {
    corner_uv[triangle][corner] = static_cast<std::uint32_t>(uv.size());
    uv.emplace_back(-1, -1);
  }
  std::vector<Warning> warnings;
  std::string out = FormatLayout(*file, uv, corner_uv, warnings);
  if (told != nullptr) *told = warnings;
  EXPECT_EQ(warnings.empty(), told == nullptr || told->empty());
  return out;
}

struct Kept {
  const char* name;
  const char* before;
  const char* after;
};

std::ostream& operator<<(std::ostream& out, const Kept& kept) { return out << kept.name; }

class ObjLayout : public ::testing::TestWithParam<Kept> {};

TEST_P(ObjLayout, ChangesTextureCoordinatesAlone) {
  const std::string out = LaidOut(GetParam().before);
  EXPECT_EQ(out, GetParam().after);
  // What is written reads back as the same surface, and writing it again changes nothing.
  const auto before = ParseObj(GetParam().before, "a"), after = ParseObj(out, "a");
  ASSERT_TRUE(after) << after.error().message;
  EXPECT_EQ(after->mesh, before->mesh);
  EXPECT_EQ(LaidOut(out), out);
}

INSTANTIATE_TEST_SUITE_P(
    Texts, ObjLayout,
    ::testing::Values(
        Kept{
            "everything",
            "# coat\nmtllib coat.mtl\no Coat\nv 0 0 0 0.2 0.4 0.6\nv 1.50 0 0\nv 0 1e0 0\nvn 0 0 "
            "1\n"
            "vt 9 9\nvt 8 8 # old\nvt 7 7\n\ng left\nusemtl silk\ns 1\nf 1/1/1 2/2/1 3/3/1  # one\n"
            "g right\nf 3//1 2//1\t1//1\nl 1/1 2/2\ncurv 1 2\n",
            "# coat\nmtllib coat.mtl\no Coat\nv 0 0 0 0.2 0.4 0.6\nv 1.50 0 0\nv 0 1e0 0\nvn 0 0 "
            "1\n"
            "vt 0 0.5\nvt 1 0.5\nvt 2 0.5\n # old\n\ng left\nusemtl silk\ns 1\n"
            "f 1/1/1 2/2/1 3/3/1  # one\ng right\nf 3/3/1 2/2/1\t1/1/1\nl 1 2\ncurv 1 2\n"},
        Kept{"none_before", "v 0 0\nv 1 0\nv 0 1\n# f\nf 1 2 3\n",
             "v 0 0\nv 1 0\nv 0 1\n# f\nvt 0 0.5\nvt 1 0.5\nvt 2 0.5\nf 1/1 2/2 3/3\n"},
        Kept{"counting_back", "v 0 0\nv 1 0\nv 0 1\nvn 0 0 1\nf -3//-1 -2//-1 -1//-1\n",
             "v 0 0\nv 1 0\nv 0 1\nvn 0 0 1\nvt 0 0.5\nvt 1 0.5\nvt 2 0.5\n"
             "f -3/1/-1 -2/2/-1 -1/3/-1\n"},
        Kept{"line_ends", "v 0 0\r\nv 1 0\r\nv 0 1\r\nvt 0 0\r\nf 1/1 2/1 \\\r\n 3/1",
             "v 0 0\r\nv 1 0\r\nv 0 1\r\nvt 0 0.5\r\nvt 1 0.5\r\nvt 2 0.5\r\nf 1/1 2/2 \\\r\n 3/3"},
        Kept{"old_ends", "v 0 0\rv 1 0\rv 0 1\rf 1 2 3\r",
             "v 0 0\rv 1 0\rv 0 1\rvt 0 0.5\rvt 1 0.5\rvt 2 0.5\rf 1/1 2/2 3/3\r"},
        Kept{"mark_at_the_head", "\xef\xbb\xbfvt 0 0\nv 0 0\nv 1 0\nv 0 1\nf 1 2 3\n",
             "\xef\xbb\xbfvt 0 0.5\nvt 1 0.5\nvt 2 0.5\nv 0 0\nv 1 0\nv 0 1\nf 1/1 2/2 3/3\n"},
        Kept{"polygons",
             "v 0 0\nv 1 0\nv 1 1\nv 0 1\nv 0.5 0.25\nf 1 2 3 4\nf 2 3 5 3\n"
             "f 3/7/ 4/7/ 1/7/ 2/7/ 2/7/\n",
             "v 0 0\nv 1 0\nv 1 1\nv 0 1\nv 0.5 0.25\nvt 0 0.5\nvt 1 0.5\nvt 2 0.5\nvt 3 0.5\n"
             "vt 4 0.5\nf 1/1 2/2 3/3 4/4\nf 2/2 3/3 5/5 3/3\nf 3/3 4/4 1/1 2/2 2/2\n"},
        Kept{"faces_first", "f 1 2 3\nvt 0 0\nv 0 0\nv 1 0\nv 0 1\n",
             "vt 0 0.5\nvt 1 0.5\nvt 2 0.5\nf 1/1 2/2 3/3\nv 0 0\nv 1 0\nv 0 1\n"},
        Kept{"all_on_one_line", "v 0 0 v 1 0 vt 3 3 v 0 1 f 1 2 3 f 3 2 1",
             "vt 0 0.5\nvt 1 0.5\nvt 2 0.5\nv 0 0 v 1 0  v 0 1 f 1/1 2/2 3/3 f 3/3 2/2 1/1"}),
    [](const auto& each) { return std::string(each.param.name); });

constexpr const char* kSquare =
    "v 0 0\nv 1 0\nv 1 1\nv 0 1\nvn 0 0 1\ng a\nf 1//1 2//1 3//1 -1//1 # q\n";

TEST(ObjLayoutCuts, APolygonThatIsCutAcrossBecomesItsTriangles) {
  std::vector<Warning> told;
  EXPECT_EQ(LaidOut(kSquare, {{1, 0}}, &told),
            "v 0 0\nv 1 0\nv 1 1\nv 0 1\nvn 0 0 1\ng a\nvt 0 0.5\nvt 1 0.5\nvt 2 0.5\nvt 3 0.5\n"
            "vt -1 -1\nf 1/1/1 2/2/1 3/3/1\nf 1/5/1 3/3/1 -1/4/1 # q\n");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].kind, "split_polygons");
  EXPECT_THAT(told[0].elements, ElementsAre(0));
  EXPECT_EQ(told[0].message,
            "faces that the layout cuts across are written as triangles, the first is that of line "
            "7 (1 in all)");
}

TEST(ObjLayoutCuts, APolygonWhoseCornerLiesElsewhereIsKept) {
  std::vector<Warning> told;
  EXPECT_EQ(LaidOut(kSquare, {{0, 1}}, &told),
            "v 0 0\nv 1 0\nv 1 1\nv 0 1\nvn 0 0 1\ng a\nvt 0 0.5\nvt 1 0.5\nvt 2 0.5\nvt 3 0.5\n"
            "vt -1 -1\nf 1/1/1 2/5/1 3/3/1 -1/4/1 # q\n");
  EXPECT_THAT(told, IsEmpty());
}

// Of a file in another format, of which nothing but the surface is known.
TEST(ObjLayoutOff, PolygonsStayPolygonsUnlessTheyAreCutAcross) {
  const auto file = ParseOff(
      "OFF 5 3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0.5\n4 0 1 2 3 0.5 1 0\n3 1 4 2\n4 3 2 1 0\n", "a");
  ASSERT_TRUE(file) << file.error().message;
  std::vector<Complex> uv{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {-1, -1}};
  std::vector<Triangle> corner_uv = file->mesh.triangles;
  corner_uv[1][0] = 5;  // of the first quad
  corner_uv[2][1] = 5;  // of the triangle
  std::vector<Warning> warnings;
  const std::string out = FormatLayout(*file, uv, corner_uv, warnings);
  EXPECT_EQ(
      out,
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0.5\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 2 0\n"
      "vt -1 -1\nf 1/1 2/2 3/3\nf 1/6 3/3 4/4\nf 2/2 5/6 3/3\nf 4/4 3/3 2/2 1/1\n");
  EXPECT_EQ(ParseObj(out, "b")->mesh, file->mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0].message, ::testing::HasSubstr("line 7 (1 in all)"));
}

TEST(InUnitSquare, ScalesAllAlike) {
  const std::vector<Complex> uv{{-200, 50}, {765.85, 60}, {0, 150}};
  const std::vector<Complex> unit = InUnitSquare(uv);
  EXPECT_EQ(unit[0], Complex(0, 0));
  EXPECT_EQ(unit[1].real(), 1);
  EXPECT_NEAR(unit[1].imag(), 10 / 965.85, 1e-15);
  EXPECT_NEAR(unit[2].real(), 200 / 965.85, 1e-15);
  EXPECT_NEAR(unit[2].imag(), 100 / 965.85, 1e-15);
  EXPECT_THAT(InUnitSquare(std::vector<Complex>{{-1.7e308, 0}, {1.7e308, 0}}),
              ElementsAre(Complex(0, 0), Complex(1, 0)));
  EXPECT_THAT(InUnitSquare(std::vector<Complex>{{3, 4}, {3, 4}}),
              ElementsAre(Complex(0, 0), Complex(0, 0)));
  EXPECT_THAT(InUnitSquare({}), IsEmpty());
}

}  // namespace
}  // namespace arap
