// What the reader of OFF makes of every oddity, alone and together with any other.
#include "core/files/off.h"

#include <gmock/gmock.h>

#include "tests/core/files/draft.h"

namespace arap {
namespace {

using testing::Draft;
using testing::DraftText;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Oddity;

std::function<void(Draft&)> Header(const std::string& header, const std::string& behind = "\n") {
  return [=](Draft& draft) {
    draft.header = header;
    draft.behind_header = behind;
  };
}

std::function<void(Draft&)> Behind(std::vector<std::vector<std::string>> Draft::*list,
                                   std::vector<std::string> words) {
  return [=](Draft& draft) {
    for (auto& one : draft.*list) one.insert(one.end(), words.begin(), words.end());
  };
}

// A word in the middle becomes a bad one.
std::function<void(Draft&)> BadCoordinate(const std::string& word) {
  return [word](Draft& draft) { draft.vertices[2][1] = "@" + word; };
}
std::function<void(Draft&)> BadCorner(const std::string& word) {
  return [word](Draft& draft) { draft.faces[1][2] = "@" + word; };
}
std::function<void(Draft&)> BadCount(std::size_t which, const std::string& word) {
  return [=](Draft& draft) { draft.counts[which] = "@" + word; };
}

const std::vector<Oddity>& Oddities() {
  static const std::vector<Oddity> all{
      {"quads", "faces",
       [](Draft& d) {
         d.faces = {{"4", "0", "1", "4", "5"}, {"4", "1", "2", "3", "4"}};
         d.counts[1] = "2";
       }},
      {"quad_and_triangles", "faces",
       [](Draft& d) {
         d.faces = {{"4", "0", "1", "4", "5"}, {"3", "1", "2", "4"}, {"3", "2", "3", "4"}};
         d.counts[1] = "3";
       }},
      {"byte_order_mark", "mark", [](Draft& d) { d.byte_order_mark = true; }},
      {"crlf", "end", [](Draft& d) { d.end = "\r\n"; }},
      {"cr", "end", [](Draft& d) { d.end = "\r"; }},
      {"no_last_end", "last", [](Draft& d) { d.last_end = false; }},
      {"tabs", "blank", [](Draft& d) { d.blank = "\t"; }},
      {"wide_blanks", "blank", [](Draft& d) { d.blank = " \t  "; }},
      {"comments_behind", "tail", [](Draft& d) { d.tail = "# 7 7 7"; }},
      {"comments", "before",
       [](Draft& d) {
         d.before = {"# OFF", "", "#"};
       }},
      {"comments_between", "between",
       [](Draft& d) {
         d.between = {"  ", "# 1 2 3"};
       }},
      {"comments_after", "after",
       [](Draft& d) {
         d.after = {"# end", ""};
       }},
      {"lower_case", "header", Header("off")},
      {"with_colours", "header", Header("COFF")},
      {"with_everything", "header", Header("STCNOFF")},
      {"lower_case_normals", "header", Header("noff")},
      {"one_line_header", "header", Header("OFF", " ")},
      {"glued_header", "header", Header("OFF", "")},
      {"no_header", "header", Header("", "")},
      {"no_edge_count", "edges", [](Draft& d) { d.counts.pop_back(); }},
      {"edge_count", "edges", [](Draft& d) { d.counts.back() = "9"; }},
      {"vertex_colours", "vertex", Behind(&Draft::vertices, {"255", "0", "0", "255"})},
      {"normals_and_colours", "vertex",
       Behind(&Draft::vertices, {"0", "0", "1", "0.5", "1", "0", "1"})},
      {"face_colours", "face", Behind(&Draft::faces, {"0.25", "0.5", "1"})},
      {"face_colour_numbers", "face", Behind(&Draft::faces, {"3"})},
      {"plus_signs", "number",
       [](Draft& d) {
         for (auto& vertex : d.vertices) vertex[0] = "+" + vertex[0];
       }},
      {"exponents", "number",
       [](Draft& d) {
         for (auto& vertex : d.vertices) vertex[0] += ".0E+00";
       }},
      {"index_too_large", "bad", BadCorner("6"), "there is no such vertex, they go from 0 to 5"},
      {"index_below_zero", "bad", BadCorner("-1"), "there is no such vertex, they go from 0 to 5"},
      {"index_beyond_any", "bad", BadCorner("99999999999999999999"), "is too large for a number"},
      {"index_with_rubbish", "bad", BadCorner("1x"), "is not a whole number"},
      {"nan", "bad", BadCoordinate("nan"), "is not a finite number"},
      {"infinity", "bad", BadCoordinate("inf"), "is not a finite number"},
      {"overflow", "bad", BadCoordinate("-1e999"), "is too large for a number"},
      {"decimal_comma", "bad", BadCoordinate("0,5"), "is not a number (decimal comma?)"},
      {"rubbish", "bad", BadCoordinate("1.5e"), "is not a number"},
      {"more_vertices_than_there_are", "bad", BadCount(0, "2000000000"),
       "the header claims 2000000000 vertices, the file has room for"},
      {"more_faces_than_there_are", "bad", BadCount(1, "3000000000"),
       "the header claims 3000000000 faces, the file has room for"},
      {"one_face_too_many", "bad", BadCount(1, "5"), "and 5 faces, the file ends after 6 and"},
      {"count_below_zero", "bad", BadCount(0, "-6"), "is not a count"},
      {"count_with_rubbish", "bad", BadCount(0, "6x"), "is not a whole number"},
      {"words_behind", "bad", [](Draft& d) { d.after.insert(d.after.begin(), "@3 0 1 2"); },
       "the file goes on behind"},
      {"a_face_of_two", "bad",
       [](Draft& d) {
         d.faces[0] = {"@2", "0", "1"};
       },
       "a face has three corners or more"},
  };
  return all;
}

void Check(const std::vector<const Oddity*>& oddities) {
  Draft draft = testing::PlainOff();
  const char* complaint = nullptr;
  for (const Oddity* oddity : oddities) {
    oddity->change(draft);
    if (oddity->complaint != nullptr) complaint = oddity->complaint;
  }
  const DraftText written = OffText(draft);
  SCOPED_TRACE(written.text);
  const Result<SurfaceFile> file = ParseOff(written.text, "a.off");
  if (complaint != nullptr) {
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().kind, FaultKind::kInvalidOption);
    EXPECT_THAT(file.error().message, HasSubstr("a.off:" + std::to_string(written.line) + ": "));
    EXPECT_THAT(file.error().message, HasSubstr(complaint));
    return;
  }
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.vertices, testing::SheetVertices());
  EXPECT_THAT(file->mesh.triangles, ::testing::ElementsAre(Triangle{0, 1, 4}, Triangle{0, 4, 5},
                                                           ::testing::_, ::testing::_));
  EXPECT_THAT(file->warnings, IsEmpty());
  EXPECT_EQ(file->face_count(), draft.faces.size());
  EXPECT_THAT(file->text, IsEmpty());
}

TEST(OffOddities, AloneAndInPairs) { testing::TryAlonePaired(Oddities(), &Check); }

// Lines cut anywhere: then there is nothing behind a vertex or a face.
TEST(Off, LinesMayBeCutAnywhere) {
  Draft word_lines = testing::PlainOff(), one_line = testing::PlainOff();
  word_lines.word_lines = true;
  one_line.one_line = true;
  for (const std::string& text : {OffText(word_lines).text, OffText(one_line).text,
                                  std::string("OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2")}) {
    const auto file = ParseOff(text, "a");
    ASSERT_TRUE(file) << text << file.error().message;
    EXPECT_GT(file->mesh.triangles.size(), 0u);
  }
  EXPECT_EQ(ParseOff(OffText(word_lines).text, "a")->mesh,
            ParseOff(OffText(one_line).text, "a")->mesh);
}

TEST(Off, FaultsNameTheLineAndTheWord) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "a: the text ends before the counts"},
      {"OFF\n", "a: the text ends before the counts"},
      {"OFF 3", "a: the text ends before the counts"},
      {"ply\n", "a:1: 'ply' is not OFF"},
      {"XOFF 3 1 0\n", "a:1: 'XOFF' is not OFF"},
      {"4OFF\n1 0 0\n", "a:1: '4OFF': only surfaces in space are read"},
      {"nOFF 3\n1 0 0\n", "a:1: 'nOFF': only surfaces in space are read"},
      {"OFF BINARY\n", "a:1: 'BINARY': only texts are read"},
      {"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "a: no faces"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3000000000 0 1 2\n",
       "a:6: '2' is the last word, 3000000000 corners of a face are wanted"},
      {"OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
       "a:2: '1': the header claims 4 vertices and 1 faces, the file ends after 4 and 0"},
      {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
       "a:4: '0' is the last word, 3 numbers of a vertex are wanted"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1 2 3 4 5\n", "a:6: '5' is one number too many"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0 red\n3 0 1 2\n", "a:5: 'red' is not a number"},
  };
  for (const auto& [text, message] : cases) {
    const auto file = ParseOff(text, "a");
    ASSERT_FALSE(file) << text;
    EXPECT_EQ(file.error(), Fault(FaultKind::kInvalidOption, message));
  }
}

}  // namespace
}  // namespace arap
