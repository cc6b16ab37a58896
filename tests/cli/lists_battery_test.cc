// Seams, pins and rigidity with every oddity of a text, alone and together with any other: what the
// plain text says, or a fault that names the line and the word.
#include <gmock/gmock.h>

#include "client/cli/commands/flatten_inputs.h"
#include "tests/core/files/draft.h"

namespace arap::cli {
namespace {

using arap::testing::Draft;
using arap::testing::DraftText;
using arap::testing::Oddities;
using arap::testing::Trial;
using ::testing::HasSubstr;

constexpr std::size_t kVertices = 9;

Draft Plain(std::vector<std::vector<std::string>> lines) {
  Draft draft;
  draft.vertices = std::move(lines);
  return draft;
}

// The line with this number, from 0, is another one.
std::function<void(Draft&)> Line(std::size_t number, const std::vector<std::string>& words) {
  return [=](Draft& draft) { draft.vertices[number] = words; };
}

// The vertex that the last line begins with is none.
Oddities BadVertices() {
  const auto bad = [](const std::string& word) {
    return [word](Draft& draft) { draft.vertices.back()[0] = "@" + word; };
  };
  return {
      {"vertex_zero", "bad", bad("0"), "vertex 0: vertices count from 1"},
      {"vertex_below_zero", "bad", bad("-2"), "vertex -2: vertices count from 1"},
      {"vertex_that_is_not_there", "bad", bad("10"), "vertex 10: the surface has 9"},
      {"vertex_beyond_any", "bad", bad("99999999999999999999"), "is too large for a number"},
      {"vertex_with_rubbish", "bad", bad("2x"), "'2x' is not a whole number"},
      {"vertex_with_fraction", "bad", bad("2.0"), "'2.0' is not a whole number"},
      {"vertex_with_comma", "bad", bad("2,"), "'2,' is not a whole number"},
      {"no_vertex", "bad", bad("nan"), "'nan' is not a whole number"},
  };
}

// `parse` answers a list of any kind.
template <class Parse>
void TryAll(const Draft& plain, const Oddities& oddities, const Parse& parse) {
  const auto expected = parse(ListText(plain).text);
  ASSERT_TRUE(expected) << expected.error().message;
  arap::testing::TryAlonePaired(plain, oddities, [&](const Trial& trial) {
    const DraftText written = ListText(trial.draft);
    SCOPED_TRACE(written.text);
    const auto list = parse(written.text);
    if (trial.complaint == nullptr) {
      ASSERT_TRUE(list) << list.error().message;
      EXPECT_EQ(*list, *expected);
      return;
    }
    ASSERT_FALSE(list);
    const std::string& message = list.error().message;
    EXPECT_EQ(list.error().kind, FaultKind::kInvalidOption);
    const std::string place = "l.txt:" + std::to_string(written.line) + ": ";
    EXPECT_TRUE(message.starts_with(place)) << message;
    EXPECT_THAT(message, HasSubstr(trial.complaint));
  });
}

TEST(ListsBattery, Pins) {
  const Oddities bad{
      {"two_words", "bad", Line(1, {"@4", "1"}), "a pin is 'vertex u v [weight]', these are 2"},
      {"five_words", "bad", Line(1, {"@4", "1", "1", "1", "1"}), "these are 5 words"},
      {"negative_weight", "bad", Line(1, {"4", "1", "1", "@-1"}), "a weight is not negative"},
  };
  TryAll(Plain({{"1", "5", "-2e1"}, {"4", "1", "1", "100"}, {"2", "3", "4"}}),
         arap::testing::Joined({arap::testing::TextOddities(), arap::testing::NumberOddities(),
                                arap::testing::BadNumbers(), BadVertices(), bad}),
         [](const std::string& text) { return ParsePins(text, "l.txt", kVertices); });
}

TEST(ListsBattery, Seams) {
  const Oddities bad{
      {"one_word", "bad", Line(1, {"@4"}), "a seam goes from one vertex to another"},
  };
  TryAll(Plain({{"1", "2", "3"}, {"4", "5"}, {"2", "6", "7", "8"}}),
         arap::testing::Joined({arap::testing::TextOddities(), BadVertices(), bad}),
         [](const std::string& text) { return ParseSeams(text, "l.txt", kVertices); });
}

TEST(ListsBattery, Rigidity) {
  const Oddities bad{
      {"two_words", "bad", Line(1, {"@4", "1"}), "a line has one rigidity, these are 2 words"},
      {"zero", "bad", Line(1, {"@0"}), "a rigidity of 0 is not above 0 and at most 1000000"},
      {"negative", "bad", Line(1, {"@-2"}), "a rigidity of -2 is not above 0"},
      {"too_large", "bad", Line(1, {"@1000001"}), "at most 1000000"},
  };
  TryAll(Plain({{"1"}, {"25"}, {"7"}}),
         arap::testing::Joined({arap::testing::TextOddities(), arap::testing::NumberOddities(),
                                arap::testing::BadNumbers(), bad}),
         [](const std::string& text) { return ParseRigidity(text, "l.txt", 3); });
}

}  // namespace
}  // namespace arap::cli
