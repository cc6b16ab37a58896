// OFF files without lines of their own for vertices and faces, and faults word by word. The oddities
// are in battery_test.cc.
#include <gtest/gtest.h>

#include "core/files/formats.h"
#include "tests/core/files/draft.h"

namespace arap {
namespace {

using testing::Draft;
using testing::OffText;

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
