// What the reader of OBJ says beside the mesh, and its faults word by word. The oddities are in
// battery_test.cc.
#include <gmock/gmock.h>

#include "core/files/formats.h"

namespace arap {
namespace {

TEST(Obj, FacesKnowTheirLinesTrianglesAndParts) {
  const auto file = ParseObj(
      "v 0 0\nv 1 0\nv 1 1\nv 0 1\nf 1 2 3\no Coat\ng left\nf 1 2 3 4\ng right\n# f\nf \\\n1 3 4\n"
      "g\nf 1 2 4\no Hat\nf 2 3 4\n",
      "a");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->face_lines, ::testing::ElementsAre(5, 8, 11, 14, 16));
  EXPECT_THAT(file->first_triangle, ::testing::ElementsAre(0, 1, 3, 4, 5, 6));
  EXPECT_EQ(file->FaceOf(0), 0u);
  EXPECT_EQ(file->FaceOf(2), 1u);
  EXPECT_EQ(file->FaceOf(5), 4u);
  EXPECT_THAT(file->CornersOf(1), ::testing::ElementsAre(0, 1, 2, 3));
  std::vector<std::string> parts;
  for (std::size_t f = 0; f < 5; ++f) {
    parts.push_back(std::string(file->ObjectOf(f)) + "/" + std::string(file->GroupOf(f)));
  }
  EXPECT_THAT(parts, ::testing::ElementsAre("/", "Coat/left", "Coat/right", "Coat/", "Hat/"));
}

TEST(Obj, WarningsCountAndNameTheFirst) {
  const auto file = ParseObj(
      "v 0 0 0 2\nv 1 0\nv 0 1 0 3\nfoo\nbar 1\nf 1/1 2 3\nfoo\nv 1 1\nf 1 2 2 3\nf 1 3 2 4\n",
      "a");
  ASSERT_TRUE(file) << file.error().message;
  std::vector<std::string> told;
  for (const Warning& warning : file->warnings) told.push_back(warning.message);
  EXPECT_THAT(
      told,
      ::testing::ElementsAre(
          "a:4: unknown statements are passed over, the first is 'foo' (3 in all)",
          "a:1: weights of vertices other than 1 do not count, the first is '2' (2 in all)",
          "a:6: corners name texture coordinates or normals that are not there, the first is '1/1' "
          "(1 in all)",
          "a:9: a face names a corner twice in a row, which counts once (1 in all)",
          "a:10: a face has no area or crosses itself and is cut from its first corner (1 in "
          "all)"));
  EXPECT_EQ(file->warnings[0].count, 3u);
  EXPECT_THAT(file->warnings[4].elements, ::testing::ElementsAre(2));
}

TEST(Obj, FaultsNameTheLineAndTheWord) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "a: no faces; 0 vertices and 0 unknown statements"},
      {"solid cube\nfacet\n", "a: no faces; 0 vertices and 2 unknown statements"},
      {"\xff\xfev", "a: the text is in UTF-16; save it as UTF-8"},
      {"v 1 2 3 4 5\n",
       "a:1: 'v' with 5 numbers: a vertex has two to four numbers, and three or four "
       "more of a colour"},
      {"v 1 2 3 4 5 6 7 8\n",
       "a:1: '8': a vertex has two to four numbers, and up to four of a colour"},
      {"v 0 0\nv 1 0\nv 0 1\nf 1 2\n", "a:4: 'f' with 2 corners: a face has three or more"},
      {"v 0 0\nv 1 0\nv 0 1\nf 1 2 3/1/1/1\n",
       "a:4: '3/1/1/1' is no corner: it has more than three indices"},
      {"v 0 0\nv 1 0\nv 0 1\nf 1 2 /1\n", "a:4: '/1' is no corner: '' is not a whole number"},
      {"v 0 0\nv 1 0\nv 0 1\nf 1 2 3/x\n", "a:4: '3/x' is no corner: 'x' is not a whole number"},
      {"v 0 0\nf -1 -2 -3\nv 1 0\nv 0 1\n",
       "a:2: '-2': there is no vertex -2, the file has 1 up to here"},
      {"v 1.000,5 0 0\n", "a:1: '1.000,5' is not a number"},
      {"v 0 0 \\\r\n \\\r\n nan\r\n", "a:3: 'nan' is not a finite number"},
      {"v 0123456789012345678901234567890123456789x 0\n",
       "a:1: '0123456789012345678901234567890123456789…' is not a number"},
  };
  for (const auto& [text, message] : cases) {
    const auto file = ParseObj(text, "a");
    ASSERT_FALSE(file) << text;
    EXPECT_EQ(file.error(), Fault(FaultKind::kInvalidOption, message));
  }
}

TEST(Obj, AConcaveFaceOfTooManyCornersNamesItsLine) {
  std::string text, face = "f";
  for (int i = 0; i < 4200; ++i) {
    text += "v " + std::to_string(i) + (i % 2 == 0 ? " 0 0\n" : " 1 0\n");
    face += " " + std::to_string(i + 1);
  }
  const auto file = ParseObj(text + "v 2000 9\n" + face + " 4201\n", "a");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().message,
            "a:4202: the face is concave and has 4201 corners; the limit is 4096");
}

}  // namespace
}  // namespace arap
