// Foreign text, as it is printed.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/cli/report.h"

namespace arap::cli {
namespace {

TEST(Printable, LeavesWritingAlone) {
  for (const char* text : {"", "a plain sentence: 3 × 7 µs …", "čeština, 日本語, 😀"}) {
    EXPECT_EQ(Printable(text), text);
  }
}

TEST(Printable, ShowsWhatSteersATerminalOrHides) {
  EXPECT_EQ(Printable("\x1b]0;title\x07\x1b[2J"), "\\x1b]0;title\\x07\\x1b[2J");
  EXPECT_EQ(Printable("one\r\ntwo\ttabs"), "one\\x0d\\x0atwo\\x09tabs");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "31m"),
            "\\x9b31m");                                               // CSI in one character
  EXPECT_EQ(Printable("\xe2\x80\xae\xe2\x81\xa6"), "\\u202e\\u2066");  // turned writing
  EXPECT_EQ(Printable("\xef\xbb\xbf"), "\\ufeff");
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a\\x00b");
}

TEST(Printable, ShowsBytesThatAreNoText) {
  EXPECT_EQ(Printable("\xff\xc0\xaf"), "\\xff\\xc0\\xaf");
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a pair
  EXPECT_EQ(Printable("\xe2\x82"), "\\xe2\\x82");           // cut off
  EXPECT_EQ(Printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(Printable, EndsWhatGoesOnForTooLong) {
  const std::string text = Printable(std::string(1'000'000, '\x1b'));
  EXPECT_LT(text.size(), 3000u);
  EXPECT_TRUE(text.ends_with("…"));
}

TEST(Printable, FaultsAndReportsAre) {
  Fault fault(FaultKind::kInternal, "\x1b[31mred");
  fault.Field("a\x1b").Detail("b\x1b", "c\x1b");
  EXPECT_EQ(Describe(fault).find('\x1b'), std::string::npos);
  const std::string text = JsonText({{"name", "\xe2\x80\xae\xff\x7f"}});
  EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) {
    return c == '\n' || (c >= ' ' && c <= '~');
  })) << testing::PrintToString(text);
}

}  // namespace
}  // namespace arap::cli
