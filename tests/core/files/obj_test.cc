// What the reader of OBJ makes of every oddity, alone and together with any other.
#include "core/files/obj.h"

#include <algorithm>

#include <gmock/gmock.h>

#include "tests/core/files/draft.h"

namespace arap {
namespace {

using testing::Draft;
using testing::DraftText;
using ::testing::HasSubstr;
using testing::Oddity;

std::string Unmarked(const std::string& word) {
  return word.starts_with('@') ? word.substr(1) : word;
}

// Every corner, as `change` makes it of its word.
void ChangeCorners(Draft& draft, const std::function<std::string(const std::string&)>& change) {
  for (auto& words : draft.faces) {
    for (std::string& word : words) {
      word = (word.starts_with('@') ? "@" : "") + change(Unmarked(word));
    }
  }
}

void Put(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

void Append(Draft& draft, const std::vector<std::string>& words) {
  for (auto& vertex : draft.vertices) Put(vertex, words);
}

// Corners with texture coordinates or normals, which are there.
std::function<void(Draft&)> Corners(const std::string& behind) {
  return [behind](Draft& draft) {
    ChangeCorners(draft, [&](const std::string& word) { return word + behind; });
    Put(draft.before, {"vt 0.5 0.5", "vn 0 0 1"});
  };
}

// The first or the last word of a vertex, or a corner, becomes a bad one.
std::function<void(Draft&)> BadCoordinate(const std::string& word) {
  return [word](Draft& draft) { draft.vertices[2][0] = "@" + word; };
}
std::function<void(Draft&)> BadCorner(const std::string& word) {
  return [word](Draft& draft) { draft.faces.back()[1] = "@" + word; };
}

const std::vector<Oddity>& Oddities() {
  static const std::vector<Oddity> all{
      {"quads", "faces",
       [](Draft& d) {
         d.faces = {{"1", "2", "5", "6"}, {"2", "3", "4", "5"}};
       }},
      {"quad_and_triangles", "faces",
       [](Draft& d) {
         d.faces = {{"1", "2", "5", "6"}, {"2", "3", "5"}, {"3", "4", "5"}};
       }},
      {"hexagon", "faces",
       [](Draft& d) {
         d.faces = {{"1", "2", "3", "4", "5", "6"}};
       }},
      {"doubled_corner", "faces",
       [](Draft& d) {
         d.faces = {{"1", "2", "2", "5", "6", "1"}, {"2", "3", "4", "5"}};
       },
       nullptr, "repeated_corners"},
      {"byte_order_mark", "mark", [](Draft& d) { d.byte_order_mark = true; }},
      {"crlf", "end", [](Draft& d) { d.end = "\r\n"; }},
      {"cr", "end", [](Draft& d) { d.end = "\r"; }},
      {"no_last_end", "last", [](Draft& d) { d.last_end = false; }},
      {"tabs", "blank", [](Draft& d) { d.blank = "\t"; }},
      {"wide_blanks", "blank", [](Draft& d) { d.blank = " \t  "; }},
      {"joined_lines", "joint", [](Draft& d) { d.joint = " \\"; }},
      {"joined_lines_glued", "joint", [](Draft& d) { d.joint = "\\ "; }},
      {"blanks_at_the_end", "tail", [](Draft& d) { d.tail = " \t"; }},
      {"comments_behind", "tail", [](Draft& d) { d.tail = " # 7 \\"; }},
      {"comments", "before",
       [](Draft& d) {
         Put(d.before, {"# C:\\sheet\\", "", "#", "  # v 1 2 3"});
       }},
      {"parts", "between",
       [](Draft& d) {
         Put(d.between, {"mtllib a b.mtl", "o Sheet # \\", "g a\\", "usemtl x\\", "s 1"});
       }},
      {"lines_and_points", "after",
       [](Draft& d) {
         Put(d.after, {"l 1 2 3", "p 1"});
       }},
      {"unknown", "after",
       [](Draft& d) {
         Put(d.after, {"curv 0 1 \\", "1 2", "cstype bezier"});
       },
       nullptr, "unknown_statements"},
      {"two_coordinates", "vertex",
       [](Draft& d) {
         for (auto& vertex : d.vertices) vertex.pop_back();
       }},
      {"weights_of_one", "vertex", [](Draft& d) { Append(d, {"1.0"}); }},
      {"weights", "vertex", [](Draft& d) { Append(d, {"0.5"}); }, nullptr, "vertex_weights"},
      {"colours", "vertex",
       [](Draft& d) {
         Append(d, {"1", "0.5", ".25"});
       }},
      {"colours_with_alpha", "vertex",
       [](Draft& d) {
         Append(d, {"1", "0.5", ".25", "1"});
       }},
      {"one_line", "line", [](Draft& d) { d.one_line = true; }},
      {"plus_signs", "number",
       [](Draft& d) {
         for (auto& vertex : d.vertices) vertex[1] = "+" + vertex[1];
       }},
      {"exponents", "number",
       [](Draft& d) {
         for (auto& vertex : d.vertices) vertex[1] += ".000e+00";
       }},
      {"too_small_for_a_double", "number", [](Draft& d) { d.vertices[1][1] = "0.001e-400"; }},
      {"textures", "corner", Corners("/1")},
      {"normals", "corner", Corners("//1")},
      {"textures_and_normals", "corner", Corners("/1/1")},
      {"attributes_that_count_back", "corner", Corners("/-1/-1")},
      {"empty_attributes", "corner", Corners("//")},
      {"attributes_that_are_not_there", "corner", Corners("/9/0"), nullptr, "unknown_references"},
      {"counting_back", "index",
       [](Draft& d) {
         for (auto& words : d.faces) {
           for (std::string& word : words) {
             if (word[0] != '@') word = std::to_string(word[0] - '0' - 7) + word.substr(1);
           }
         }
       }},
      {"faces_first", "index", [](Draft& d) { d.faces_first = true; }},
      {"index_zero", "bad", BadCorner("0"), "there is no vertex 0, they count from 1"},
      {"index_too_large", "bad", BadCorner("7"), "there is no vertex 7, the file has 6"},
      {"index_too_far_back", "bad", BadCorner("-99"), "there is no vertex -99, the file has"},
      {"index_beyond_any", "bad", BadCorner("99999999999999999999"), "is too large for a number"},
      {"index_with_rubbish", "bad", BadCorner("2x"), "'2x' is not a whole number"},
      {"index_with_fraction", "bad", BadCorner("2.5"), "'2.5' is not a whole number"},
      {"nan", "bad", BadCoordinate("nan"), "is not a finite number"},
      {"infinity", "bad", BadCoordinate("-inf"), "is not a finite number"},
      {"overflow", "bad", BadCoordinate("1e999"), "is too large for a number"},
      {"decimal_comma", "bad", BadCoordinate("1,5"), "is not a number (decimal comma?)"},
      {"rubbish", "bad", BadCoordinate("1.5mm"), "is not a number"},
      {"hexadecimal", "bad", BadCoordinate("0x10"), "is not a number"},
      {"face_without_corners", "bad", [](Draft& d) { d.between.push_back("@f"); },
       "a face has three or more"},
      {"one_coordinate", "bad", [](Draft& d) { d.after.push_back("@v"); },
       "a vertex has two to four numbers"},
  };
  return all;
}

double AreaOf(const SurfaceMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Point3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
  }
  return area;
}

void Check(const std::vector<const Oddity*>& oddities) {
  Draft draft = testing::PlainObj();
  std::vector<std::string> warnings;
  const char* complaint = nullptr;
  for (const Oddity* oddity : oddities) {
    oddity->change(draft);
    if (oddity->complaint != nullptr) complaint = oddity->complaint;
    if (oddity->warning != nullptr) warnings.emplace_back(oddity->warning);
  }
  const DraftText written = ObjText(draft);
  SCOPED_TRACE(written.text);
  const Result<SurfaceFile> file = ParseObj(written.text, "a.obj");
  if (complaint != nullptr) {
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().kind, FaultKind::kInvalidOption);
    EXPECT_THAT(file.error().message, HasSubstr("a.obj:" + std::to_string(written.line) + ": "));
    EXPECT_THAT(file.error().message, HasSubstr("'" + written.word));
    EXPECT_THAT(file.error().message, HasSubstr(complaint));
    return;
  }
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.vertices, testing::SheetVertices());
  EXPECT_EQ(file->mesh.triangles.size(), 4u);
  EXPECT_EQ(AreaOf(file->mesh), 200);
  std::vector<std::string> told;
  for (const Warning& warning : file->warnings) told.push_back(warning.kind);
  EXPECT_THAT(told, ::testing::UnorderedElementsAreArray(warnings));
  EXPECT_EQ(file->face_count(), draft.faces.size());
  EXPECT_EQ(file->text, written.text);
}

TEST(ObjOddities, AloneAndInPairs) { testing::TryAlonePaired(Oddities(), &Check); }

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
