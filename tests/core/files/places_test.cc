// Texts as other programs write them, where in them something stands, and whether a file can be
// written.
#include <filesystem>

#include <gmock/gmock.h>
#include <unistd.h>

#include "core/files/json_text.h"
#include "core/files/text_file.h"
#include "tests/support/folder.h"

namespace arap {
namespace {

using testing::HasSubstr;

class Texts : public FolderTest {};

TEST_F(Texts, AByteOrderMarkIsPassedOver) {
  EXPECT_EQ(ReadTextFile(Put("a",
                             "\xef\xbb\xbf"
                             "1 2\n")),
            "1 2\n");
  EXPECT_EQ(ReadTextFile(Put("b", "1\xef\xbb\xbf")), "1\xef\xbb\xbf");
  EXPECT_EQ(ReadTextFile(Put("c", "\xef\xbb\xbf")), "");
}

TEST_F(Texts, PlacesAreLinesAndCharacters) {
  struct Case {
    std::string_view text;
    std::size_t offset, line, column;
  };
  for (const Case& c : std::initializer_list<Case>{{"", 0, 1, 1},
                                                   {"", 7, 1, 1},
                                                   {"ab\ncd", 1, 1, 2},
                                                   {"ab\ncd", 2, 1, 3},
                                                   {"ab\ncd", 3, 2, 1},
                                                   {"ab\r\ncd", 3, 1, 3},
                                                   {"ab\r\ncd", 4, 2, 1},
                                                   {"ab\rcd", 4, 2, 2},
                                                   {"ab\n", 3, 2, 1},
                                                   {"\r\r\n\nab", 5, 4, 2},
                                                   {"ab", 99, 1, 3},
                                                   {"\xc3\xa4\xe2\x82\xacz", 5, 1, 3}}) {
    const TextPlace place = PlaceAt(c.text, c.offset);
    EXPECT_EQ(place, (TextPlace{c.line, c.column})) << c.text << " at " << c.offset;
  }
}

std::string JsonFault(std::string_view text) {
  const auto json = ParseJson(text, "a.json");
  return json ? "no fault" : json.error().message;
}

TEST_F(Texts, JsonFaultsHaveLineAndColumn) {
  EXPECT_EQ(JsonFault("[1, {\"a\": null}]"), "no fault");
  EXPECT_EQ(JsonFault(""),
            "a.json:1:1: not JSON: unexpected end of input; expected '[', '{', or a literal");
  EXPECT_EQ(JsonFault("[1,\n  2\n  3]"),
            "a.json:3:3: not JSON: unexpected number literal; expected ']'");
  EXPECT_THAT(JsonFault("{\"a\":\r [1,\r\nNaN]}"), HasSubstr("a.json:3:1: not JSON: invalid"));
  EXPECT_THAT(JsonFault("[1e999]"), HasSubstr("a.json:1:6: not JSON: number overflow"));
  EXPECT_THAT(JsonFault("[\"\xff\"]"), HasSubstr("a.json:1:3: not JSON: invalid string"));
  // Depth costs neither stack nor memory.
  EXPECT_EQ(JsonFault(std::string(1'000'000, '[')),
            "a.json:1:101: lists and objects are nested too deeply");
  // Neither do values of a character.
  std::string empties = "[";
  while (empties.size() < 4'000'000) empties += "[],";
  EXPECT_THAT(JsonFault(empties + "0]"), HasSubstr("so many short values take too much memory"));
  EXPECT_EQ(JsonFault("[" + empties.substr(1, 30'000) + "0]"), "no fault");
  EXPECT_EQ(JsonFault(std::string(100, '[') + "\"\\\"[\"" + std::string(100, ']')), "no fault");
  // What was read is not said again at any length.
  EXPECT_LT(JsonFault("\"" + std::string(1'000'000, 'x')).size(), 200u);
}

TEST_F(Texts, ValuesOfJsonHavePlaces) {
  constexpr std::string_view kText = R"({
  "a": [1, "x]\"[", {"b": [true,
    null]}],
  "a b": {"c" : -1.5e3},
  "list": [[0, 1],
           [2, 3]]
})";
  const auto place = [&](const std::vector<JsonStep>& steps) {
    return JsonPlace(kText, "f", steps);
  };
  ASSERT_TRUE(ParseJson(kText, "f"));
  EXPECT_EQ(place({}), "f:1:1");
  EXPECT_EQ(place({"a"}), "f:2:8");
  EXPECT_EQ(place({"a", 1u}), "f:2:12");
  EXPECT_EQ(place({"a", 2u, "b", 1u}), "f:3:5");
  EXPECT_EQ(place({"a b", "c"}), "f:4:17");
  EXPECT_EQ(place({"list", 1u}), "f:6:12");
  EXPECT_EQ(place({"list", 1u, 1u}), "f:6:16");
  // As far as it goes.
  EXPECT_EQ(place({"nowhere"}), "f:1:1");
  EXPECT_EQ(place({"list", 2u}), "f:5:11");
  EXPECT_EQ(place({"list", "b"}), "f:5:11");
  EXPECT_EQ(place({"a", 0u, 0u}), "f:2:9");
  EXPECT_EQ(JsonPlace("[1, 2]", "f", {1u}), "f:1:5");
  EXPECT_EQ(JsonPlace(R"({"a": 1, "a": 2})", "f", {"a"}), "f:1:15");
}

TEST_F(Texts, WhatCannotBeWrittenIsKnownBefore) {
  const auto fault = [](const std::string& path) {
    const Status writable = CheckWritable(path);
    return writable ? "no fault" : writable.error().message;
  };
  const std::string file = Put("file", "before");
  for (const std::string& good :
       {Path("new"), file, std::string("/dev/null"), std::string("/dev/stdout")}) {
    EXPECT_EQ(fault(good), "no fault") << good;
  }
  const std::pair<std::string, const char*> bad[] = {
      {Path("nowhere/new"), "No such file or directory"},
      {Path("file/new"), "Not a directory"},
      {Path("."), "it is a folder"},
      {Path(""), "it is a folder"},
      {Path("new/"), "there is no name of a file"},
      {"", "there is no name of a file"},
  };
  for (const auto& [path, reason] : bad) {
    EXPECT_EQ(fault(path), "cannot write " + path + ": " + reason);
  }
  std::filesystem::create_symlink(Path("nowhere/new"), Path("lost"));
  std::filesystem::create_symlink(Path("new"), Path("fresh"));
  EXPECT_THAT(fault(Path("lost")), HasSubstr("No such file or directory"));
  EXPECT_EQ(fault(Path("fresh")), "no fault");
  EXPECT_EQ(ReadTextFile(file), "before");
  EXPECT_FALSE(std::filesystem::exists(Path("new")));
}

TEST_F(Texts, AFolderThatTakesNoNewFileMayLetAnOldOneBeWritten) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  std::filesystem::create_directory(Path("closed"));
  Put("closed/old", "");
  std::filesystem::permissions(Path("closed"), std::filesystem::perms(0500));
  EXPECT_FALSE(CheckWritable(Path("closed/new")));
  EXPECT_TRUE(CheckWritable(Path("closed/old")));
  std::filesystem::permissions(Path("closed"), std::filesystem::perms(0700));
  std::filesystem::permissions(Path("closed/old"), std::filesystem::perms(0400));
  EXPECT_TRUE(CheckWritable(Path("closed/old")));  // another file takes its place
}

}  // namespace
}  // namespace arap
