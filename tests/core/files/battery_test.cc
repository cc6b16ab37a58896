// What the readers of OBJ and OFF make of every oddity, alone and together with any other: the mesh of
// the plain file bit by bit, so that all that comes of it is the same too, or a fault that names the
// line and the word.
#include <algorithm>

#include <gmock/gmock.h>

#include "core/files/formats.h"
#include "tests/core/files/draft.h"

namespace arap {
namespace {

using testing::Draft;
using testing::DraftText;
using ::testing::HasSubstr;
using testing::Oddities;
using testing::Trial;

using Words = std::vector<std::string>;

void Put(Words& lines, const Words& more) { lines.insert(lines.end(), more.begin(), more.end()); }

// Words behind all vertices or all faces.
std::function<void(Draft&)> Behind(std::vector<Words> Draft::*list, const Words& words) {
  return [=](Draft& draft) {
    for (Words& one : draft.*list) Put(one, words);
  };
}

// Every corner of an OBJ face, as `change` makes it of its word.
void ChangeCorners(Draft& draft, const std::function<std::string(const std::string&)>& change) {
  for (Words& words : draft.faces) {
    for (std::string& word : words) {
      const bool marked = word.starts_with('@');
      word = (marked ? "@" : "") + change(word.substr(marked ? 1 : 0));
    }
  }
}

// Corners with texture coordinates or normals, which are there.
std::function<void(Draft&)> Corners(const std::string& behind) {
  return [behind](Draft& draft) {
    ChangeCorners(draft, [&](const std::string& word) { return word + behind; });
    Put(draft.before, {"vt 0.5 0.5", "vn 0 0 1"});
  };
}

std::function<void(Draft&)> Faces(const std::vector<Words>& faces) {
  return [faces](Draft& draft) {
    draft.faces = faces;
    if (!draft.counts.empty()) draft.counts[1] = std::to_string(faces.size());
  };
}

// The last but one word of the last face becomes a bad corner.
std::function<void(Draft&)> BadCorner(const std::string& word) {
  return [word](Draft& draft) { draft.faces.back().rbegin()[1] = "@" + word; };
}

Oddities ObjOddities() {
  const Oddities faces{
      {"quads", "faces", Faces({{"1", "2", "5", "6"}, {"2", "3", "4", "5"}})},
      {"quad_and_triangles", "faces",
       Faces({{"1", "2", "5", "6"}, {"2", "3", "4"}, {"2", "4", "5"}})},
      {"concave_hexagon", "faces", Faces({{"1", "2", "3", "4", "5", "6"}})},
      {"doubled_corner", "faces", Faces({{"1", "2", "2", "5", "6", "1"}, {"2", "3", "4", "5"}}),
       nullptr, "repeated_corners"},
  };
  const Oddities own{
      {"joined_lines", "joint", [](Draft& d) { d.joint = " \\"; }},
      {"joined_lines_glued", "joint", [](Draft& d) { d.joint = "\\ "; }},
      {"backslashes_in_comments", "tail", [](Draft& d) { d.tail = " # 7 \\"; }},
      {"backslashes_in_lines_of_comments", "before",
       [](Draft& d) {
         Put(d.before, {"# C:\\sheet\\", "#"});
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
         for (Words& vertex : d.vertices) vertex.pop_back();
       }},
      {"weights_of_one", "vertex", Behind(&Draft::vertices, {"1.0"})},
      {"weights", "vertex", Behind(&Draft::vertices, {"0.5"}), nullptr, "vertex_weights"},
      {"colours", "vertex", Behind(&Draft::vertices, {"1", "0.5", ".25"})},
      {"colours_with_alpha", "vertex", Behind(&Draft::vertices, {"1", "0.5", ".25", "1"})},
      {"one_line", "line", [](Draft& d) { d.one_line = true; }},
      {"too_small_for_a_double", "number", [](Draft& d) { d.vertices[1][1] = "0.001e-400"; }},
      {"textures", "corner", Corners("/1")},
      {"normals", "corner", Corners("//1")},
      {"textures_and_normals", "corner", Corners("/1/1")},
      {"attributes_that_count_back", "corner", Corners("/-1/-1")},
      {"empty_attributes", "corner", Corners("//")},
      {"attributes_that_are_not_there", "corner", Corners("/9/0"), nullptr, "unknown_references"},
      {"counting_back", "index",
       [](Draft& d) {
         ChangeCorners(d, [](const std::string& word) {
           return std::to_string(word[0] - '0' - 7) + word.substr(1);
         });
       }},
      {"faces_first", "index", [](Draft& d) { d.faces_first = true; }},
  };
  const Oddities bad{
      {"index_zero", "bad", BadCorner("0"), "there is no vertex 0, they count from 1"},
      {"index_too_large", "bad", BadCorner("7"), "there is no vertex 7, the file has 6"},
      {"index_too_far_back", "bad", BadCorner("-99"), "there is no vertex -99, the file has"},
      {"index_beyond_any", "bad", BadCorner("99999999999999999999"), "is too large for a number"},
      {"index_with_rubbish", "bad", BadCorner("2x"), "'2x' is not a whole number"},
      {"index_with_fraction", "bad", BadCorner("2.5"), "'2.5' is not a whole number"},
      {"index_that_is_none", "bad", BadCorner("nan"), "'nan' is not a whole number"},
      {"fourth_index", "bad", BadCorner("2/1/1/1"), "it has more than three indices"},
      {"face_without_corners", "bad", [](Draft& d) { d.between.push_back("@f"); },
       "a face has three or more"},
      {"face_of_two_corners", "bad", [](Draft& d) { d.between.push_back("@f 1 2"); },
       "a face has three or more"},
      {"one_coordinate", "bad", [](Draft& d) { d.after.push_back("@v 1"); },
       "a vertex has two to four numbers"},
      {"five_coordinates", "bad", [](Draft& d) { d.after.push_back("@v 1 2 3 4 5"); },
       "a vertex has two to four numbers"},
  };
  return testing::Joined(
      {faces, testing::TextOddities(), testing::NumberOddities(), own, testing::BadNumbers(), bad});
}

std::function<void(Draft&)> Header(const std::string& header, const std::string& behind = "\n") {
  return [=](Draft& draft) {
    draft.header = header;
    draft.behind_header = behind;
  };
}

std::function<void(Draft&)> BadCount(std::size_t which, const std::string& word) {
  return [=](Draft& draft) { draft.counts[which] = "@" + word; };
}

Oddities OffOddities() {
  const Oddities faces{
      {"quads", "faces", Faces({{"4", "0", "1", "4", "5"}, {"4", "1", "2", "3", "4"}})},
      {"quad_and_triangles", "faces",
       Faces({{"4", "0", "1", "4", "5"}, {"3", "1", "2", "3"}, {"3", "1", "3", "4"}})},
      {"concave_hexagon", "faces", Faces({{"6", "0", "1", "2", "3", "4", "5"}})},
      {"doubled_corner", "faces",
       Faces({{"6", "0", "1", "1", "4", "5", "0"}, {"4", "1", "2", "3", "4"}}), nullptr,
       "repeated_corners"},
  };
  const Oddities own{
      {"comments_between", "between",
       [](Draft& d) {
         d.between = {"  ", "# 1 2 3"};
       }},
      {"lower_case", "header", Header("off")},
      {"with_colours", "header", Header("COFF")},
      {"with_everything", "header", Header("STCNOFF")},
      {"lower_case_normals", "header", Header("noff")},
      {"one_line_header", "header", Header("OFF", " ")},
      {"glued_header", "header", Header("OFF", "")},
      {"glued_lower_case_header", "header", Header("off", "")},
      {"no_header", "header", Header("", "")},
      {"no_edge_count", "edges", [](Draft& d) { d.counts.pop_back(); }},
      {"edge_count", "edges", [](Draft& d) { d.counts.back() = "9"; }},
      {"vertex_colours", "vertex", Behind(&Draft::vertices, {"255", "0", "0", "255"})},
      {"normals_and_colours", "vertex",
       Behind(&Draft::vertices, {"0", "0", "1", "0.5", "1", "0", "1"})},
      {"face_colours", "face", Behind(&Draft::faces, {"0.25", "0.5", "1"})},
      {"face_colour_numbers", "face", Behind(&Draft::faces, {"3"})},
  };
  const auto bad_corner = [](const std::string& word) {
    return [word](Draft& draft) { draft.faces[0][2] = "@" + word; };
  };
  const Oddities bad{
      {"index_too_large", "bad", bad_corner("6"), "there is no such vertex, they go from 0 to 5"},
      {"index_below_zero", "bad", bad_corner("-1"), "there is no such vertex, they go from 0 to 5"},
      {"index_beyond_any", "bad", bad_corner("99999999999999999999"), "is too large for a number"},
      {"index_with_rubbish", "bad", bad_corner("1x"), "is not a whole number"},
      {"more_vertices_than_there_are", "bad", BadCount(0, "2000000000"),
       "the header claims 2000000000 vertices, the file has room for"},
      {"more_faces_than_there_are", "bad", BadCount(1, "3000000000"),
       "the header claims 3000000000 faces, the file has room for"},
      {"count_below_zero", "bad", BadCount(0, "-6"), "is not a count"},
      {"count_with_rubbish", "bad", BadCount(0, "6x"), "is not a whole number"},
      {"one_vertex_too_many", "bad",
       [](Draft& d) {
         d.counts[0] = "7";
         d.counts[1] = "@" + d.counts[1];
       },
       "the header claims 7 vertices and"},
      {"one_face_too_many", "bad",
       [](Draft& d) { d.counts[1] = "@" + std::to_string(d.faces.size() + 1); },
       "faces, the file ends after 6 and"},
      {"one_face_too_few", "bad",
       [](Draft& d) {
         d.counts[1] = std::to_string(d.faces.size() - 1);
         d.faces.back()[0] = "@" + d.faces.back()[0];
       },
       "the file goes on behind the 6 vertices and"},
      {"words_behind", "bad", [](Draft& d) { d.after.insert(d.after.begin(), "@3 0 1 2"); },
       "the file goes on behind"},
      {"a_face_of_two", "bad",
       [](Draft& d) {
         d.faces[0] = {"@2", "0", "1"};
       },
       "a face has three corners or more"},
      {"a_face_of_billions", "bad",
       [](Draft& d) {
         d.faces.back() = {"3000000000", "1", "3", "@4"};
       },
       "is the last word, 3000000000 corners of a face are wanted"},
  };
  return testing::Joined(
      {faces, testing::TextOddities(), testing::NumberOddities(), own, testing::BadNumbers(), bad});
}

void CheckFile(const Trial& trial, const Result<SurfaceFile>& file, const DraftText& written,
               const SurfaceMesh& plain) {
  SCOPED_TRACE(written.text);
  if (trial.complaint != nullptr) {
    ASSERT_FALSE(file);
    const std::string& message = file.error().message;
    EXPECT_EQ(file.error().kind, FaultKind::kInvalidOption);
    EXPECT_TRUE(message.starts_with("a:" + std::to_string(written.line) + ": ")) << message;
    EXPECT_THAT(message, HasSubstr("'" + written.word));
    EXPECT_THAT(message, HasSubstr(trial.complaint));
    return;
  }
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->face_count(), trial.draft.faces.size());
  Words told;
  for (const Warning& warning : file->warnings) told.push_back(warning.kind);
  EXPECT_THAT(told, ::testing::UnorderedElementsAreArray(trial.warnings));
  if (!trial.Has("concave_hexagon")) {
    EXPECT_EQ(file->mesh, plain);
    return;
  }
  // There are several ways to cut it.
  EXPECT_EQ(file->mesh.vertices, plain.vertices);
  EXPECT_EQ(file->mesh.triangles.size(), plain.triangles.size());
  double area = 0;
  for (const Triangle& t : file->mesh.triangles) {
    const Point3 &a = plain.vertices[t[0]], &b = plain.vertices[t[1]], &c = plain.vertices[t[2]];
    const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  EXPECT_EQ(area, testing::SheetArea());
}

const SurfaceMesh& PlainMesh() {
  static const SurfaceMesh mesh{testing::SheetVertices(),
                                {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}};
  return mesh;
}

TEST(Battery, Obj) {
  testing::TryAlonePaired(testing::PlainObj(), ObjOddities(), [](const Trial& trial) {
    const DraftText written = ObjText(trial.draft);
    const auto file = ParseObj(written.text, "a");
    CheckFile(trial, file, written, PlainMesh());
    EXPECT_TRUE(!file || file->text == written.text);
  });
}

TEST(Battery, Off) {
  testing::TryAlonePaired(testing::PlainOff(), OffOddities(), [](const Trial& trial) {
    const DraftText written = OffText(trial.draft);
    const auto file = ParseOff(written.text, "a");
    CheckFile(trial, file, written, PlainMesh());
    EXPECT_TRUE(!file || file->text.empty());
  });
}

}  // namespace
}  // namespace arap
