#include "client/cli/load/histogram.h"

#include <algorithm>
#include <cmath>

namespace arap::cli {
namespace {

constexpr std::size_t kParts = 64;  // of a doubling
constexpr std::size_t kDoublings = 36;
constexpr double kShortest = 1.0 / 16;
constexpr double kLongest = 4294967296.0;  // kShortest doubled so often

double LowOf(std::size_t index) {
  const double part = 1 + static_cast<double>(index % kParts) / kParts;
  return std::ldexp(kShortest * part, static_cast<int>(index / kParts));
}

std::size_t IndexOf(double micros) {
  if (!(micros >= kShortest)) return 0;
  if (micros >= kLongest) return kParts * kDoublings - 1;
  int exponent = 0;
  const double half = std::frexp(micros / kShortest, &exponent);  // from 0.5 on and below 1
  return static_cast<std::size_t>(exponent - 1) * kParts +
         static_cast<std::size_t>((2 * half - 1) * kParts);
}

}  // namespace

std::uint64_t& Histogram::At(std::size_t index) {
  const std::size_t doubling = index / kParts * kParts;
  if (counts_.empty()) first_ = doubling;
  if (doubling < first_) {
    counts_.insert(counts_.begin(), first_ - doubling, 0);
    first_ = doubling;
  }
  if (index - first_ >= counts_.size()) counts_.resize(doubling + kParts - first_);
  return counts_[index - first_];
}

void Histogram::Record(double micros, std::uint64_t count) {
  if (count == 0) return;
  if (!(micros >= 0)) micros = 0;
  micros = std::min(micros, kLongest);
  At(IndexOf(micros)) += count;
  min_ = count_ == 0 ? micros : std::min(min_, micros);
  max_ = std::max(max_, micros);
  sum_ += micros * static_cast<double>(count);
  count_ += count;
}

void Histogram::Merge(const Histogram& other) {
  if (other.count_ == 0) return;
  At(other.first_);
  At(other.first_ + other.counts_.size() - 1);
  for (std::size_t i = 0; i < other.counts_.size(); ++i) {
    counts_[other.first_ + i - first_] += other.counts_[i];
  }
  min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
  max_ = std::max(max_, other.max_);
  sum_ += other.sum_;
  count_ += other.count_;
}

double Histogram::Mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }

double Histogram::Quantile(double q) const {
  if (count_ == 0) return 0;
  const double rank = std::ceil(std::clamp(q, 0.0, 1.0) * static_cast<double>(count_));
  if (rank <= 1) return min_;
  if (rank >= static_cast<double>(count_)) return max_;
  double below = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    below += static_cast<double>(counts_[i]);
    if (counts_[i] == 0 || below < rank) continue;
    const double middle = (LowOf(first_ + i) + LowOf(first_ + i + 1)) / 2;
    return std::clamp(middle, min_, max_);
  }
  return max_;
}

double Histogram::PartWithin(double micros) const {
  if (count_ == 0 || micros < min_) return 0;
  if (micros >= max_) return 1;
  const std::size_t last = IndexOf(micros);
  double within = 0;
  for (std::size_t i = 0; i < counts_.size() && first_ + i <= last; ++i) {
    within += static_cast<double>(counts_[i]);
  }
  return within / static_cast<double>(count_);
}

std::vector<Histogram::Bucket> Histogram::Buckets() const {
  std::vector<Bucket> buckets;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] == 0) continue;
    buckets.push_back({LowOf(first_ + i), LowOf(first_ + i + 1), counts_[i]});
  }
  return buckets;
}

std::optional<Histogram> Histogram::Of(std::span<const Bucket> buckets, double min, double max,
                                       double sum) {
  Histogram histogram;
  if (buckets.empty())
    return min == 0 && max == 0 && sum == 0 ? std::optional(histogram) : std::nullopt;
  double last = 0;
  for (const Bucket& bucket : buckets) {
    const std::size_t index = IndexOf(bucket.low);
    if (bucket.count == 0 || bucket.low <= last || LowOf(index) != bucket.low) return std::nullopt;
    last = bucket.low;
    histogram.At(index) = bucket.count;
    if (histogram.count_ + bucket.count < bucket.count) return std::nullopt;
    histogram.count_ += bucket.count;
  }
  const bool plausible = min >= 0 && min <= max && max <= kLongest && std::isfinite(sum) &&
                         IndexOf(min) == IndexOf(buckets.front().low) &&
                         IndexOf(max) == IndexOf(buckets.back().low);
  if (!plausible) return std::nullopt;
  histogram.min_ = min;
  histogram.max_ = max;
  histogram.sum_ = sum;
  return histogram;
}

}  // namespace arap::cli
