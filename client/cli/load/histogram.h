// How often which time was seen, in memory that does not grow with how often.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace arap::cli {

// Times in microseconds from 1/16 µs to 2^32 µs (71 minutes), each within 0.8 % of what was recorded:
// every doubling has 64 buckets of equal width, and a time is told as the middle of its bucket. Count,
// Min, Max and Mean are exact. Shorter times count in the first bucket and longer ones in the last,
// and so does what is no time: NaN in the first.
//
// Only the doublings between the shortest and the longest time take memory, 512 bytes each and 18 kB
// at most. Recording takes some 10 ns and allocates when such a doubling is new. Not for several
// threads at once: give each its own and Merge them.
class Histogram {
 public:
  // From `low` on and below `high`. All bounds are sums of few powers of 2, and so exact in any text.
  struct Bucket {
    double low = 0, high = 0;
    std::uint64_t count = 0;
    bool operator==(const Bucket&) const = default;
  };

  void Record(double micros, std::uint64_t count = 1);
  // As if everything that `other` has seen had been recorded here.
  void Merge(const Histogram& other);

  std::uint64_t Count() const { return count_; }
  double Min() const { return min_; }  // 0 when nothing was recorded; so are all of these
  double Max() const { return max_; }
  double Mean() const;
  double Sum() const { return sum_; }
  // The shortest time that the part `q` of all times, from 0 to 1, does not exceed.
  double Quantile(double q) const;
  // The part of all times that are `micros` or shorter, from 0 to 1.
  double PartWithin(double micros) const;

  // The buckets that have any, by time.
  std::vector<Bucket> Buckets() const;
  // What Buckets, Min, Max and Sum said of another one; only `low` and `count` of a bucket count.
  // Nothing where they cannot have come from one: a bound that no bucket has, buckets that are empty
  // or out of order, or times that are not within them.
  static std::optional<Histogram> Of(std::span<const Bucket> buckets, double min, double max,
                                     double sum);

 private:
  // Makes room for the bucket, and answers its count.
  std::uint64_t& At(std::size_t index);

  std::size_t first_ = 0;              // the index of counts_[0], at the beginning of a doubling
  std::vector<std::uint64_t> counts_;  // whole doublings
  std::uint64_t count_ = 0;
  double min_ = 0, max_ = 0, sum_ = 0;
};

}  // namespace arap::cli
