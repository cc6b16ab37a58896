// Records as text: exact, and suspicious of text from elsewhere.
#include "server/store/record_format.h"

#include <gtest/gtest.h>

#include "tests/server/store/records.h"

namespace arap::store {
namespace {

TEST(RecordFormatTest, RandomRecordsComeBackBitForBit) {
  testing::Random random(11);
  for (int round = 0; round < 2000; ++round) {
    const SessionRecord record = testing::RandomRecord(random);
    const auto text = EncodeRecord(record);
    ASSERT_TRUE(text) << text.error().message;
    const auto back = DecodeRecord(*text);
    ASSERT_TRUE(back) << *text;
    ASSERT_EQ(testing::Difference(record, *back), "") << *text;
  }
}

TEST(RecordFormatTest, RefusesWhatIsNoRecord) {
  for (const char* text : {"", "{}", "[]", "null", "7", "{\"format\":1}", "no JSON"}) {
    const auto record = DecodeRecord(text);
    ASSERT_FALSE(record) << text;
    EXPECT_EQ(record.error().kind, FaultKind::kDataLoss);
  }
}

TEST(RecordFormatTest, RefusesAnotherVersion) {
  std::string text = *EncodeRecord(testing::PlainRecord("ann", "s"));
  const std::size_t at = text.find("\"format\":1");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 10, "\"format\":2");
  const auto record = DecodeRecord(text);
  ASSERT_FALSE(record);
  EXPECT_EQ(record.error().kind, FaultKind::kStoreUnavailable) << "it is not lost";
  EXPECT_NE(record.error().message.find("later version, in format 2"), std::string::npos)
      << record.error().message;
}

// Cut or with a byte changed: refused or another record, never a crash.
TEST(RecordFormatTest, SurvivesDamage) {
  testing::Random random(12);
  const std::string text = *EncodeRecord(testing::PlainRecord("ann", "s"));
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_FALSE(DecodeRecord(std::string_view(text).substr(0, size)));
  }
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = text;
    damaged[random.Below(text.size())] = static_cast<char>(random.Below(256));
    const auto record = DecodeRecord(damaged);
    // A changed number of the format is a later version's.
    EXPECT_TRUE(record || record.error().kind == FaultKind::kDataLoss ||
                record.error().message.find("in format ") != std::string::npos);
  }
}

TEST(RecordFormatTest, AStringThatIsNotUtf8IsAFault) {
  SessionRecord record = testing::PlainRecord("ann", "s");
  record.labels["x"] = "\xff\xfe";
  const auto text = EncodeRecord(record);
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().kind, FaultKind::kInternal);
}

}  // namespace
}  // namespace arap::store
