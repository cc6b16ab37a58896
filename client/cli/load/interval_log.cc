#include "client/cli/load/interval_log.h"

#include <algorithm>
#include <utility>

namespace arap::cli {
namespace {

constexpr double kLongestRun = 1e9;  // seconds

}  // namespace

IntervalLog::Cell& IntervalLog::At(Operation operation, double at) {
  at = at > 0 ? std::min(at, kLongestRun) : 0;  // NaN is 0
  while (at >= length_ * kMost) Double();
  const auto index = static_cast<std::size_t>(at / length_);
  if (index >= cells_.size()) cells_.resize(index + 1);
  return cells_[index][operation];
}

void IntervalLog::Double() {
  length_ *= 2;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cells cells;
    std::swap(cells, cells_[i]);
    Cells& to = cells_[i / 2];
    for (std::size_t k = 0; k < kOperations; ++k) {
      Cell& target = to[static_cast<Operation>(k)];
      const Cell& source = cells[static_cast<Operation>(k)];
      target.offered += source.offered;
      target.failed += source.failed;
      target.response.Merge(source.response);
    }
  }
  cells_.resize((cells_.size() + 1) / 2);
}

void IntervalLog::Offered(Operation operation, double at) { ++At(operation, at).offered; }

void IntervalLog::Answered(Operation operation, double at, double micros) {
  At(operation, at).response.Record(micros);
}

void IntervalLog::Failed(Operation operation, double at) { ++At(operation, at).failed; }

void IntervalLog::Merge(const IntervalLog& other) {
  while (length_ < other.length_) Double();
  for (std::size_t i = 0; i < other.cells_.size(); ++i) {
    for (std::size_t k = 0; k < kOperations; ++k) {
      const auto operation = static_cast<Operation>(k);
      const Cell& source = other.cells_[i][operation];
      if (source.offered + source.failed + source.response.Count() == 0) continue;
      Cell& target = At(operation, static_cast<double>(i) * other.length_);
      target.offered += source.offered;
      target.failed += source.failed;
      target.response.Merge(source.response);
    }
  }
}

std::vector<Interval> IntervalLog::Intervals(double end) const {
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Interval& interval = intervals.emplace_back();
    interval.start = static_cast<double>(i) * length_;
    interval.seconds = length_;
    for (std::size_t k = 0; k < kOperations; ++k) {
      const auto operation = static_cast<Operation>(k);
      const Cell& cell = cells_[i][operation];
      const Histogram& response = cell.response;
      interval.operations[operation] = {
          cell.offered,           response.Count(),        cell.failed,
          response.Quantile(0.5), response.Quantile(0.99), response.Max()};
    }
  }
  if (!intervals.empty() && end > intervals.back().start) {
    intervals.back().seconds = std::min(length_, end - intervals.back().start);
  }
  return intervals;
}

}  // namespace arap::cli
