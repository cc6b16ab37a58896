// The pieces of the load generator that know neither a clock nor a wire.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "client/cli/load/chance.h"
#include "client/cli/load/rates.h"
#include "client/cli/load/scene.h"
#include "client/cli/load/schedule.h"
#include "client/cli/load/tally.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

TEST(RateProfile, CountsWhatIsDueAndSaysWhen) {
  const struct {
    const char* text;
    double seconds, time, count;
  } cases[] = {
      {"step:100", 10, 10, 1000},   {"step:100", 10, 2.5, 250}, {"step:100,300", 10, 5, 500},
      {"step:100,300", 10, 6, 800}, {"step:0,50", 4, 2, 0},     {"ramp:0,100", 10, 10, 500},
      {"ramp:0,100", 10, 5, 125},   {"ramp:100,0", 10, 5, 375}, {"ramp:100,1000", 9, 9, 4950},
  };
  for (const auto& one : cases) {
    const auto profile = RateProfile::Parse(one.text, one.seconds);
    ASSERT_TRUE(profile) << one.text << ": " << profile.error().message;
    EXPECT_NEAR(profile->seconds(), one.seconds, 1e-9) << one.text;
    EXPECT_NEAR(profile->Before(one.time), one.count, 1e-6) << one.text;
    for (double count = 0; count < profile->Before(one.seconds) - 1; count += 7.5) {
      const auto when = profile->When(count);
      ASSERT_TRUE(when) << one.text << " " << count;
      EXPECT_NEAR(profile->Before(*when), count, 1e-6) << one.text;
    }
    EXPECT_FALSE(profile->When(profile->Before(one.seconds) + 1e-3)) << one.text;
  }
}

TEST(RateProfile, KnowsItsPieces) {
  const auto steps = RateProfile::Parse("step:10,20,40", 6);
  ASSERT_TRUE(steps);
  EXPECT_EQ(steps->PieceAt(0), 0u);
  EXPECT_EQ(steps->PieceAt(2), 1u);
  EXPECT_EQ(steps->PieceAt(5.9), 2u);
  EXPECT_EQ(steps->PieceAt(100), 2u);
}

TEST(RateProfile, WarmsUpBeforeEachPiece) {
  const auto steps = RateProfile::Parse("step:10,20", 4);
  ASSERT_TRUE(steps);
  const RateProfile warm = steps->WarmedUp(3);
  EXPECT_NEAR(warm.seconds(), 10, 1e-9);
  EXPECT_NEAR(warm.Before(3), 30, 1e-9);
  EXPECT_NEAR(warm.Before(5), 50, 1e-9);
  EXPECT_NEAR(warm.Before(8), 110, 1e-9) << "at the rate of the next";
  ASSERT_EQ(warm.pieces().size(), 4u);
  for (const std::size_t i : {0u, 1u, 2u, 3u}) EXPECT_EQ(warm.pieces()[i].counts, i % 2 == 1) << i;
  for (const auto& [time, counted] :
       {std::pair(-1.0, 0.0), std::pair(3.0, 0.0), std::pair(4.5, 1.5), std::pair(7.0, 2.0),
        std::pair(10.0, 4.0), std::pair(11.0, 5.0)}) {
    EXPECT_NEAR(warm.Counted(time), counted, 1e-9) << time;
  }
  // A ramp goes on where it was.
  const auto ramp = RateProfile::Parse("ramp:0,100", 10);
  ASSERT_TRUE(ramp);
  const RateProfile slow = ramp->WarmedUp(1);
  ASSERT_EQ(slow.pieces().size(), 20u);
  for (std::size_t i = 1; i < 20; ++i)
    EXPECT_EQ(slow.pieces()[i].from, slow.pieces()[i - 1].to) << i;
  EXPECT_EQ(ramp->WarmedUp(0).pieces().size(), 10u);
}

TEST(RateProfile, RefusesWhatIsNone) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "no colon"},
      {"100", "no colon"},
      {"stairs:1", "neither"},
      {"ramp:1", "two rates"},
      {"ramp:1,2,3", "two rates"},
      {"step:", "not a rate"},
      {"step:1,,2", "not a rate"},
      {"step:-1", "not a rate"},
      {"step:nan", "not a rate"},
      {"step:1x", "not a rate"},
      {"step:0", "nothing is ever"},
      {"step:1e9", "not a rate"},
  };
  for (const auto& [text, why] : cases) {
    const auto profile = RateProfile::Parse(text, 10);
    ASSERT_FALSE(profile) << text;
    EXPECT_EQ(profile.error().field, "profile");
    EXPECT_THAT(profile.error().message, HasSubstr(why)) << text;
  }
}

std::vector<Moment> TimesOf(const RateProfile& profile, const ArrivalShare& share) {
  std::vector<Moment> times;
  Arrivals arrivals(std::make_shared<const RateProfile>(profile), share);
  for (; arrivals.next(); arrivals.Advance()) times.push_back(*arrivals.next());
  return times;
}

TEST(Arrivals, OfAllStreamsAreEvenlySpaced) {
  const RateProfile profile = RateProfile::Constant(100, 2);
  std::vector<Moment> all;
  for (std::size_t stream = 0; stream < 4; ++stream) {
    const auto times = TimesOf(profile, {stream, 4});
    EXPECT_EQ(times.size(), 50u);
    all.insert(all.end(), times.begin(), times.end());
  }
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(SecondsOf(all[i]), 0.01 * static_cast<double>(i), 1e-6);
  }
}

TEST(Arrivals, OfPeopleComeAsPoissonSays) {
  const RateProfile profile = RateProfile::Constant(1000, 100);
  std::vector<std::size_t> counts(1000);  // in tenths of a second
  std::size_t all = 0;
  for (std::size_t stream = 0; stream < 8; ++stream) {
    const auto times = TimesOf(profile, {stream, 8, true, 7});
    EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
    for (const Moment time : times) ++counts[static_cast<std::size_t>(SecondsOf(time) * 10)];
    all += times.size();
  }
  // Drawn once and for all by the seed: the bounds are five standard deviations.
  EXPECT_NEAR(static_cast<double>(all), 100'000, 5 * std::sqrt(100'000));
  double variance = 0;
  for (const std::size_t count : counts) {
    variance += std::pow(static_cast<double>(count) - 100, 2) / static_cast<double>(counts.size());
  }
  EXPECT_NEAR(variance, 100, 25) << "as large as the mean";
}

TEST(Arrivals, OfStreamsThatAreAloneBeginAtOnce) {
  const RateProfile profile = RateProfile::Constant(50, 1);
  const auto times = TimesOf(profile, {3, 1, false, 0, true});
  EXPECT_EQ(times.size(), 50u);
  EXPECT_EQ(times, TimesOf(profile, {7, 1, false, 0, true}));
  EXPECT_EQ(times.front(), Moment(0));
  EXPECT_NE(TimesOf(profile, {3, 1, true, 0, true}), TimesOf(profile, {7, 1, true, 0, true}));
}

TEST(Arrivals, AreTheSameForTheSameSeed) {
  const RateProfile profile = RateProfile::Constant(50, 10);
  const auto times = TimesOf(profile, {3, 5, true, 1});
  EXPECT_EQ(times, TimesOf(profile, {3, 5, true, 1}));
  EXPECT_NE(times, TimesOf(profile, {3, 5, true, 2}));
  EXPECT_NE(times, TimesOf(profile, {4, 5, true, 1}));
}

TEST(Mix, GivesEveryOperationItsShare) {
  const auto mix = Mix::Parse("drag=90,edit=5,bake=2.5,register=2.5");
  ASSERT_TRUE(mix) << mix.error().message;
  PerOperation<double> counts{};
  constexpr int kDrawn = 40'000;
  for (std::uint64_t i = 0; i < kDrawn; ++i) ++counts[mix->At(1, i % 7, i)];
  EXPECT_NEAR(counts[Operation::kDrag] / kDrawn, 0.9, 0.01);
  EXPECT_NEAR(counts[Operation::kEdit] / kDrawn, 0.05, 0.01);
  EXPECT_NEAR(counts[Operation::kBake] / kDrawn, 0.025, 0.01);
  EXPECT_NEAR(counts[Operation::kRegister] / kDrawn, 0.025, 0.01);
  EXPECT_EQ(counts[Operation::kFlatten], 0);
  EXPECT_FALSE(mix->Has(Operation::kFlatten));
  for (std::uint64_t i = 0; i < 100; ++i) EXPECT_EQ(mix->At(1, 2, i), mix->At(1, 2, i));
}

TEST(Mix, RefusesWhatIsNone) {
  for (const char* text : {"", "drag", "drag=", "drag=x", "drag=-1", "drag=nan", "fly=1",
                           "drag=1,,edit=1", "drag=1,drag=2", "drag=0", "drag=1e12"}) {
    const auto mix = Mix::Parse(text);
    ASSERT_FALSE(mix) << text;
    EXPECT_EQ(mix.error().field, "mix");
  }
}

// Servers that bear so many a second.
TEST(RateSearch, FindsTheHighestRateToItsResolution) {
  for (const double bears : {0.5, 3.0, 100.0, 777.0, 25'000.0}) {
    RateSearch search(100, 0.05);
    std::size_t tried = 0;
    while (search.next()) {
      ASSERT_LT(++tried, 40u);
      search.Tried(*search.next() <= bears);
    }
    ASSERT_TRUE(search.found()) << bears;
    EXPECT_LE(*search.found(), bears);
    EXPECT_GE(*search.found() * 1.05, bears);
  }
}

TEST(RateSearch, EndsWhereNothingOrEverythingIsMet) {
  RateSearch none(100, 0.05), all(100, 0.05);
  for (int i = 0; i < 100 && none.next(); ++i) none.Tried(false);
  EXPECT_FALSE(none.next());
  EXPECT_FALSE(none.found());
  for (int i = 0; i < 100 && all.next(); ++i) all.Tried(true);
  EXPECT_FALSE(all.next());
  EXPECT_EQ(all.found(), RateSearch::kHighest);
}

TEST(StabilityRule, WantsFiveSecondsThatAgree) {
  StabilityRule rule(10);
  for (const double median : {400.0, 100.0, 101.0, 99.0, 102.0}) EXPECT_FALSE(rule.Add(50, median));
  EXPECT_TRUE(rule.Add(51, 100)) << "the first is forgotten";
  EXPECT_FALSE(rule.Add(80, 100)) << "another rate";
  StabilityRule silent(10);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(silent.Add(0, 0));
}

TEST(LoadScene, HasTheVerticesAndHandlesThatWereAsked) {
  for (const std::size_t vertices : {4u, 300u, 1000u, 5000u}) {
    const LoadScene scene = MakeLoadScene(vertices, 8);
    EXPECT_NEAR(static_cast<double>(scene.mesh.vertices.size()), static_cast<double>(vertices),
                0.05 * static_cast<double>(vertices));
    EXPECT_EQ(scene.handles.size(), 8u);
    EXPECT_EQ(scene.rests.size(), 8u);
    EXPECT_EQ(scene.surface.vertices.size(), scene.mesh.vertices.size());
  }
}

TEST(LoadScene, TargetsComeOfTheSeed) {
  const LoadScene scene = MakeLoadScene(100, 4);
  EXPECT_EQ(TargetsOf(scene, 1, 2, 3), TargetsOf(scene, 1, 2, 3));
  EXPECT_NE(TargetsOf(scene, 1, 2, 3), TargetsOf(scene, 2, 2, 3));
  EXPECT_NE(TargetsOf(scene, 1, 2, 3), TargetsOf(scene, 1, 3, 3));
  EXPECT_NE(TargetsOf(scene, 1, 2, 3), TargetsOf(scene, 1, 2, 4));
}

}  // namespace
}  // namespace arap::cli
