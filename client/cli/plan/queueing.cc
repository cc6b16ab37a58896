#include "client/cli/plan/queueing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <vector>

#include "client/cli/load/chance.h"

namespace arap::cli {
namespace {

constexpr std::size_t kUpdates = 200'000;
constexpr std::size_t kBefore = kUpdates / 10;

// UpdateTimes in their order.
class UpdateTimes {
 public:
  explicit UpdateTimes(const QueueInput& input) : input_(input) {
    // Of more streams than updates it makes no difference that each sends evenly.
    if (input.streams == 0 || input.streams > kUpdates) return;
    period_ = static_cast<double>(input.streams) / input.rate;
    for (std::size_t i = 0; i < input.streams; ++i) {
      phases_.push_back(period_ * DrawPart(input.seed, Draw::kArrival, i, 0));
    }
    std::sort(phases_.begin(), phases_.end());
  }

  double Next() {
    const std::size_t number = count_++;
    if (phases_.empty()) {
      // 1 - x is never 0.
      now_ -= std::log(1 - DrawPart(input_.seed, Draw::kArrival, 0, number)) / input_.rate;
      return now_;
    }
    const auto round = number / phases_.size();
    return static_cast<double>(round) * period_ + phases_[number % phases_.size()];
  }

 private:
  const QueueInput& input_;
  std::vector<double> phases_;
  double period_ = 0;
  double now_ = 0;
  std::size_t count_ = 0;
};

// The time that the `number`-th update takes.
double ServiceTime(const QueueInput& input, std::size_t number) {
  if (input.variation <= 0) return input.service;
  // Of a lognormal distribution with this mean and deviation.
  const double spread = std::log1p(input.variation * input.variation);
  const double u = 1 - DrawPart(input.seed, Draw::kOperation, 0, number);
  const double v = DrawPart(input.seed, Draw::kOperation, 1, number);
  const double normal = std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  return input.service * std::exp(std::sqrt(spread) * normal - spread / 2);
}

}  // namespace

QueueTimes SimulateQueue(const QueueInput& input) {
  QueueTimes times;
  times.utilization = input.rate * input.service / static_cast<double>(input.workers);
  times.stable = input.rate > 0 && times.utilization < 1;
  if (!times.stable) return times;
  std::priority_queue<double, std::vector<double>, std::greater<>> free;
  for (std::size_t i = 0; i < input.workers; ++i) free.push(0);
  UpdateTimes arrivals(input);
  std::vector<double> taken;
  taken.reserve(kUpdates);
  double sum = 0;
  for (std::size_t i = 0; i < kBefore + kUpdates; ++i) {
    const double arrival = arrivals.Next();
    const double end = std::max(arrival, free.top()) + ServiceTime(input, i);
    free.pop();
    free.push(end);
    if (i < kBefore) continue;
    taken.push_back(end - arrival);
    sum += taken.back();
  }
  const auto quantile = [&taken](double part) {
    const auto at = taken.begin() + static_cast<std::ptrdiff_t>(part * (kUpdates - 1));
    std::nth_element(taken.begin(), at, taken.end());
    return *at;
  };
  times.mean = sum / kUpdates;
  times.p50 = quantile(0.5);
  times.p90 = quantile(0.9);
  times.p99 = quantile(0.99);
  return times;
}

}  // namespace arap::cli
