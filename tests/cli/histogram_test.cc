// The histogram of times, and the log of intervals that is made of them.
#include "client/cli/load/histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "client/cli/load/interval_log.h"

namespace arap::cli {
namespace {

// The smallest sample that the part `q` of them does not exceed.
double Exact(std::vector<double> samples, double q) {
  std::sort(samples.begin(), samples.end());
  const double rank = std::max(1.0, std::ceil(q * static_cast<double>(samples.size())));
  return samples[static_cast<std::size_t>(rank) - 1];
}

TEST(Histogram, QuantilesAreWithinAPercentOverItsWholeRange) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(std::log(0.1), std::log(3.6e9));
  Histogram histogram;
  std::vector<double> samples;
  for (int i = 0; i < 20'000; ++i) {
    samples.push_back(std::exp(exponent(random)));
    histogram.Record(samples.back());
  }
  for (const double q : {0.0, 0.001, 0.01, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
    const double exact = Exact(samples, q);
    EXPECT_NEAR(histogram.Quantile(q), exact, 0.008 * exact) << q;
  }
  EXPECT_EQ(histogram.Count(), samples.size());
  EXPECT_EQ(histogram.Min(), Exact(samples, 0));
  EXPECT_EQ(histogram.Max(), Exact(samples, 1));
  EXPECT_NEAR(histogram.PartWithin(Exact(samples, 0.25)), 0.25, 0.01);
}

TEST(Histogram, EveryBucketIsAtMostASixtyFourthOfItsTimeWideAndHasItsBounds) {
  Histogram histogram;
  for (double micros = 1.0 / 16; micros < 4e9; micros *= 1.003) histogram.Record(micros);
  double last = 1.0 / 16;
  for (const Histogram::Bucket& bucket : histogram.Buckets()) {
    EXPECT_EQ(bucket.low, last) << "no gap";
    EXPECT_LE(bucket.high - bucket.low, bucket.low / 64);
    last = bucket.high;
    Histogram low, below;
    low.Record(bucket.low);
    below.Record(std::nextafter(bucket.high, 0));
    EXPECT_EQ(low.Buckets().at(0).low, bucket.low);
    EXPECT_EQ(below.Buckets().at(0).low, bucket.low);
  }
}

TEST(Histogram, MergedIsAsIfRecordedInOne) {
  std::mt19937_64 random(3);
  std::lognormal_distribution<double> times(6, 2);
  Histogram all, odd, even;
  for (int i = 0; i < 1000; ++i) {
    const double micros = times(random);
    all.Record(micros);
    (i % 2 == 0 ? even : odd).Record(micros);
  }
  Histogram merged;
  merged.Merge(odd);
  merged.Merge(Histogram());
  merged.Merge(even);
  EXPECT_EQ(merged.Buckets(), all.Buckets());
  EXPECT_EQ(merged.Min(), all.Min());
  EXPECT_EQ(merged.Max(), all.Max());
  EXPECT_NEAR(merged.Mean(), all.Mean(), 1e-9 * all.Mean());
}

TEST(Histogram, OfWhatOneSaidIsThatOne) {
  Histogram histogram;
  histogram.Record(0.01, 3);
  histogram.Record(123.4);
  histogram.Record(1e12);
  const auto buckets = histogram.Buckets();
  const auto again = Histogram::Of(buckets, histogram.Min(), histogram.Max(), histogram.Sum());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->Buckets(), buckets);
  EXPECT_EQ(again->Count(), 5u);
  EXPECT_EQ(again->Quantile(0.5), histogram.Quantile(0.5));
  EXPECT_TRUE(Histogram::Of({}, 0, 0, 0));
}

TEST(Histogram, OfWhatNoneCanHaveSaidIsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using Buckets = std::vector<Histogram::Bucket>;
  EXPECT_FALSE(Histogram::Of(Buckets{{128.5, 0, 1}}, 128.5, 128.5, 128.5)) << "no bucket's bound";
  EXPECT_FALSE(Histogram::Of(Buckets{{nan, 0, 1}}, 1, 1, 1));
  EXPECT_FALSE(Histogram::Of(Buckets{{128, 0, 0}}, 128, 128, 0)) << "empty";
  EXPECT_FALSE(Histogram::Of(Buckets{{128, 0, 1}, {64, 0, 1}}, 64, 128, 192)) << "out of order";
  EXPECT_FALSE(Histogram::Of(Buckets{{128, 0, 1}}, 1, 128, 128)) << "the shortest lies elsewhere";
  EXPECT_FALSE(Histogram::Of(Buckets{{128, 0, 1}}, 128, nan, 128));
  EXPECT_FALSE(Histogram::Of(Buckets{{128, 0, 1}}, 128, 128, nan));
  EXPECT_FALSE(Histogram::Of({}, 1, 1, 1));
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  EXPECT_FALSE(Histogram::Of(Buckets{{64, 0, kMost}, {128, 0, 1}}, 64, 128, 1e21)) << "too many";
}

TEST(Histogram, TakesWhatIsNoTime) {
  Histogram histogram;
  for (const double micros : {std::numeric_limits<double>::quiet_NaN(), -5.0, 0.0,
                              std::numeric_limits<double>::infinity()}) {
    histogram.Record(micros);
  }
  EXPECT_EQ(histogram.Count(), 4u);
  EXPECT_EQ(histogram.Min(), 0);
  EXPECT_EQ(histogram.Max(), 4294967296.0);
  EXPECT_TRUE(std::isfinite(histogram.Mean()));
  EXPECT_EQ(Histogram().Quantile(0.5), 0);
  EXPECT_EQ(Histogram().Mean(), 0);
}

TEST(IntervalLog, HasAnIntervalForEachSecond) {
  IntervalLog log;
  log.Offered(Operation::kDrag, 0.2);
  log.Answered(Operation::kDrag, 2.5, 2'300'000);
  log.Failed(Operation::kBake, 2.6);
  const std::vector<Interval> intervals = log.Intervals(2.75);
  ASSERT_EQ(intervals.size(), 3u);
  EXPECT_EQ(intervals[0].operations[Operation::kDrag].offered, 1u);
  EXPECT_EQ(intervals[1].operations[Operation::kDrag].offered, 0u);
  EXPECT_EQ(intervals[2].operations[Operation::kDrag].answered, 1u);
  EXPECT_EQ(intervals[2].operations[Operation::kDrag].max, 2'300'000);
  EXPECT_EQ(intervals[2].operations[Operation::kBake].failed, 1u);
  EXPECT_EQ(intervals[2].start, 2);
  EXPECT_EQ(intervals[2].seconds, 0.75);
}

TEST(IntervalLog, GoesToTheEndOfTheRunAndNotBeyond) {
  IntervalLog log;
  log.Offered(Operation::kDrag, 0.5);
  EXPECT_EQ(log.Intervals(4).size(), 4u) << "nothing happened is something that happened";
  log.Answered(Operation::kDrag, 4.001, 10);
  const std::vector<Interval> intervals = log.Intervals(4);
  ASSERT_EQ(intervals.size(), 4u);
  EXPECT_EQ(intervals.back().operations[Operation::kDrag].answered, 1u);
  EXPECT_EQ(log.Intervals(100'000).size(), 195u) << "of 512 seconds";
  ASSERT_EQ(log.Intervals(3.001).size(), 3u) << "a thousandth of a second is no interval";
  EXPECT_DOUBLE_EQ(log.Intervals(3.001).back().seconds, 1.001);
  EXPECT_EQ(log.Intervals(0.001).size(), 1u);
  EXPECT_TRUE(log.Intervals(0).empty());
}

TEST(IntervalLog, IsBoundedHoweverLongTheRun) {
  IntervalLog log;
  for (int second = 0; second < 3600; ++second) {
    log.Answered(Operation::kDrag, second + 0.5, 10 + second);
  }
  const std::vector<Interval> intervals = log.Intervals(3600);
  EXPECT_LE(intervals.size(), IntervalLog::kMost);
  EXPECT_GT(intervals.size(), IntervalLog::kMost / 2 - 1);
  std::uint64_t answered = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    answered += intervals[i].operations[Operation::kDrag].answered;
    EXPECT_EQ(intervals[i].start, 16.0 * static_cast<double>(i));
    EXPECT_EQ(intervals[i].seconds, 16);
    EXPECT_EQ(intervals[i].operations[Operation::kDrag].max, 10 + 16 * (i + 1) - 1);
  }
  EXPECT_EQ(answered, 3600u);
  log.Answered(Operation::kDrag, std::numeric_limits<double>::infinity(), 1);
  log.Answered(Operation::kDrag, std::numeric_limits<double>::quiet_NaN(), 1);
  EXPECT_LE(log.Intervals(1e9).size(), IntervalLog::kMost);
}

TEST(IntervalLog, MergesLogsOfOtherLengths) {
  IntervalLog coarse, fine, all;
  for (int i = 0; i < 600; ++i) {
    (i % 3 == 0 ? fine : coarse).Offered(Operation::kDrag, i % 3 == 0 ? i % 100 : i);
    all.Offered(Operation::kDrag, i % 3 == 0 ? i % 100 : i);
  }
  IntervalLog one = coarse, other = fine;
  one.Merge(fine);
  other.Merge(coarse);
  const auto expected = all.Intervals(600);
  for (const auto& merged : {one.Intervals(600), other.Intervals(600)}) {
    ASSERT_EQ(merged.size(), expected.size());
    for (std::size_t i = 0; i < merged.size(); ++i) {
      EXPECT_EQ(merged[i].start, expected[i].start);
      EXPECT_EQ(merged[i].operations[Operation::kDrag].offered,
                expected[i].operations[Operation::kDrag].offered);
    }
  }
}

}  // namespace
}  // namespace arap::cli
