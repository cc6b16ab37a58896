// Drawings of a layout as a job has them made: in order, told and measured, in memory that is bounded.
#include "server/flattening/drawings.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/support/fake_clock.h"
#include "tests/support/surfaces.h"

namespace arap::app::drawn {
namespace {

using ::testing::HasSubstr;

class DrawAllTest : public ::testing::Test {
 protected:
  DrawAllTest() : flat_(arap::Flatten(testing::SphereCap(4, 12, 1.0), {}).value()) {
    for (const DrawingFormat format :
         {DrawingFormat::kDxf, DrawingFormat::kSvg, DrawingFormat::kDxf}) {
      drawings_.emplace_back().format = format;
    }
  }

  Result<Drawn> DrawThem(DerivedCache& derived, std::size_t most_bytes = 0,
                         const CancelToken& cancel = {}) {
    told_.clear();
    return DrawAll(
        derived, metrics_, {}, {drawings_, {}, {}, most_bytes}, flat_, cancel,
        [this](std::string_view phase, double fraction) { told_.emplace_back(phase, fraction); });
  }
  // What the metrics say of drawing.
  void ExpectCounted(int times) {
    EXPECT_THAT(metrics_.Text(), HasSubstr("arapd_phase_seconds_count{phase=\"draw\"} " +
                                           std::to_string(times) + "\n"));
  }

  Flattening flat_;
  std::vector<DrawingOptions> drawings_;
  runtime::FakeClock clock_;
  runtime::Metrics metrics_;
  DerivedCache derived_{std::size_t{1} << 30u, {4, std::size_t{1} << 20u}, clock_};
  std::vector<std::pair<std::string, double>> told_;
};

TEST_F(DrawAllTest, AllAreMadeToldAndMeasured) {
  const auto drawn = DrawThem(derived_);
  ASSERT_TRUE(drawn) << drawn.error().message;
  ASSERT_EQ(drawn->drawings.size(), 3u);
  EXPECT_EQ(drawn->drawings[0].files, drawn->drawings[2].files);
  EXPECT_THAT(drawn->drawings[0].files[0].bytes, HasSubstr("$INSUNITS"));
  EXPECT_THAT(drawn->drawings[1].files[0].bytes, HasSubstr("<svg"));
  // Behind the layout and before the end, ever further.
  ASSERT_EQ(told_.size(), 3u);
  double last = 0.8;
  for (const auto& [phase, fraction] : told_) {
    EXPECT_EQ(phase, "drawing");
    EXPECT_GT(fraction, last);
    EXPECT_LT(fraction, 0.97);
    last = fraction;
  }
  ExpectCounted(1);
}

TEST_F(DrawAllTest, NothingIsToldWhereNothingIsDrawn) {
  drawings_.clear();
  const auto drawn = DrawThem(derived_);
  ASSERT_TRUE(drawn);
  EXPECT_TRUE(drawn->drawings.empty());
  EXPECT_TRUE(told_.empty());
  ExpectCounted(0);
}

TEST_F(DrawAllTest, FaultsNameTheDrawing) {
  drawings_[1].sheet_width = 1e-3;
  const auto narrow = DrawThem(derived_);
  ASSERT_FALSE(narrow);
  EXPECT_EQ(narrow.error().field, "drawings[1].sheet_width");
  ExpectCounted(0);

  const CancelToken cancelled([]() -> Status { return Fail(FaultKind::kCancelled, "enough"); });
  const auto ended = DrawThem(derived_, 0, cancelled);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, FaultKind::kCancelled);
}

TEST_F(DrawAllTest, MemoryAndBytesAreBounded) {
  DerivedCache small(1'000, {4, 100}, clock_);
  const auto refused = DrawThem(small);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);

  const auto whole = DrawThem(derived_);
  ASSERT_TRUE(whole);
  std::size_t bytes = 0;
  for (const Drawing& drawing : whole->drawings) bytes += drawing.files[0].bytes.size();
  EXPECT_TRUE(DrawThem(derived_, bytes));
  const auto large = DrawThem(derived_, bytes - 1);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().field, "max_response_bytes");
}

}  // namespace
}  // namespace arap::app::drawn
