// How what a client has sent is shown.
#include "core/base/names.h"

#include <string>

#include <gtest/gtest.h>

namespace arap {
namespace {

TEST(NamesTest, QuotesAreHarmless) {
  EXPECT_EQ(Quote("plain"), "\"plain\"");
  EXPECT_EQ(Quote("line\nbreak\x01"), "\"line?break?\"");
  EXPECT_EQ(Quote(std::string(1'000, 'x')).size(), 64u + 5u);
}

}  // namespace
}  // namespace arap
