#include "client/cli/load/interval_log.h"

#include <algorithm>
#include <cmath>
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
    Add(cells, cells_[i / 2]);
  }
  cells_.resize((cells_.size() + 1) / 2);
}

void IntervalLog::Offered(Operation operation, double at) { ++At(operation, at).offered; }
void IntervalLog::Late(Operation operation, double at) { ++At(operation, at).late; }
void IntervalLog::Unsent(Operation operation, double at) { ++At(operation, at).unsent; }
void IntervalLog::Replaced(Operation operation, double at) { ++At(operation, at).replaced; }

void IntervalLog::Answered(Operation operation, double at, double micros) {
  At(operation, at).response.Record(micros);
}

void IntervalLog::Failed(Operation operation, double at) { ++At(operation, at).failed; }

void IntervalLog::Merge(const IntervalLog& other) {
  while (length_ < other.length_) Double();
  for (std::size_t i = 0; i < other.cells_.size(); ++i) {
    const double start = static_cast<double>(i) * other.length_;
    At(Operation::kDrag, start);  // makes room
    Add(other.cells_[i], cells_[static_cast<std::size_t>(start / length_)]);
  }
}

void IntervalLog::Add(const Cells& from, Cells& to) {
  for (std::size_t k = 0; k < kOperations; ++k) {
    const auto operation = static_cast<Operation>(k);
    to[operation].offered += from[operation].offered;
    to[operation].failed += from[operation].failed;
    to[operation].late += from[operation].late;
    to[operation].unsent += from[operation].unsent;
    to[operation].replaced += from[operation].replaced;
    to[operation].response.Merge(from[operation].response);
  }
}

std::vector<Interval> IntervalLog::Intervals(double end) const {
  end = end > 0 ? std::min(end, kLongestRun) : 0;  // NaN is 0
  IntervalLog log = *this;
  while (end > log.length_ * kMost) log.Double();
  const double length = log.length_;
  auto count = static_cast<std::size_t>(std::ceil(end / length));
  if (count == 0) return {};
  // A rest that is shorter than half an interval would tell of chance alone.
  if (count > 1 && end - static_cast<double>(count - 1) * length < length / 2) --count;
  for (std::size_t i = count; i < log.cells_.size(); ++i) Add(log.cells_[i], log.cells_[count - 1]);
  log.cells_.resize(count);
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i < count; ++i) {
    Interval& interval = intervals.emplace_back();
    interval.start = static_cast<double>(i) * length;
    interval.seconds = i + 1 < count ? length : end - interval.start;
    for (std::size_t k = 0; k < kOperations; ++k) {
      const auto operation = static_cast<Operation>(k);
      const Cell& cell = log.cells_[i][operation];
      const Histogram& response = cell.response;
      interval.operations[operation] = {cell.offered,
                                        response.Count(),
                                        cell.failed,
                                        response.Quantile(0.5),
                                        response.Quantile(0.99),
                                        response.Max(),
                                        cell.late,
                                        cell.unsent,
                                        cell.replaced};
    }
  }
  return intervals;
}

}  // namespace arap::cli
