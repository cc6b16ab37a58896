// Tally: what became of the messages of a run, counted as they come. It knows no clock: every moment
// is told.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/load/interval_log.h"
#include "client/cli/load/rates.h"
#include "client/cli/load/results.h"
#include "client/cli/load/schedule.h"
#include "core/base/mutex.h"

namespace arap::cli {

// What is sent so much later than was intended was sent late: the generator, or the transport's
// back-pressure, has held it up. Its time counts from when it was intended all the same.
inline constexpr Moment kLateAfter = std::chrono::milliseconds(1);

// Whether a rate was held: of what was due at least 98 % was answered, or replaced by what was.
constexpr bool IsHeld(std::uint64_t offered, std::uint64_t answered, std::uint64_t replaced) {
  return 100 * (answered + replaced) >= 98 * offered;
}

// A message on its way.
struct Sent {
  Operation operation = Operation::kDrag;
  Moment intended{0}, sent{0};
};

// The server's own times, where its answer tells them.
struct ServerTimes {
  double queue_micros = 0, solve_micros = 0;
};

// What happened since somebody asked last.
struct Glance {
  std::uint64_t answered = 0, failed = 0;
  Histogram response;
};

// Whether a run has said what there is to be said: its last kSeconds seconds each answered as many
// messages, with the same median of their response, as they did on average, within so many percent.
class StabilityRule {
 public:
  static constexpr std::size_t kSeconds = 5;

  explicit StabilityRule(double percent) : within_(percent / 100) {}

  // A second has gone by. Whether the run is stable now; a second without answers never is.
  bool Add(double answered, double median);

 private:
  using Values = std::array<double, kSeconds>;
  bool Agree(const Values& values) const;

  double within_;
  std::size_t seen_ = 0;
  Values answered_{}, medians_{};
};

// Thread-safe. Messages count when they were intended at `from` or later; errors of those before count
// too, with their kinds, so that none goes unseen. Memory is bounded: histograms, intervals and steps.
class Tally {
 public:
  // `steps`: the profile whose pieces are told apart, from `from` on, and of which those count that say so;
  // or nothing.
  explicit Tally(Moment from, std::shared_ptr<const RateProfile> steps = nullptr);

  void CountSent(const Sent& message);
  void CountUnsent(Operation operation, Moment intended);
  void CountAnswered(const Sent& message, Moment answered, std::optional<ServerTimes> times);
  void CountFailed(const Sent& message, Moment now);
  void CountReplaced(const Sent& message);
  void CountVerified(Operation operation, bool right);
  // Something went wrong, whether or not with a message.
  void CountError(const Fault& fault);
  void CountBadReply(const std::string& sentence);
  void CountRefused(double micros);
  void CountResumed();
  void CountLost(std::uint64_t frames);
  void CountEcho(Moment intended, double micros);

  Glance TakeGlance();

  // Adds what counts to the results, but intervals and steps, which need all tallies.
  void AddTo(LoadResults& results) const;
  // Adds errors, refusals and losses, which count whenever they were.
  void AddTroublesTo(LoadResults& results) const;
  // The intervals up to `end`, and the steps with what was answered in each, of all tallies together. A
  // step is met when it was held.
  static void AddTimes(const std::vector<std::unique_ptr<Tally>>& tallies, Moment end,
                       LoadResults& results);

 private:
  struct Step {
    std::uint64_t offered = 0, answered = 0, replaced = 0;
    Histogram response;
  };

  Step* StepOf(Moment intended) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::size_t PieceOf(Moment intended) const;
  bool Counts(Moment intended) const;
  // How many seconds that count have gone by.
  double At(Moment moment) const;
  void Note(const std::string& code, const std::string& reason, const std::string& sentence)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Moment from_;
  const std::shared_ptr<const RateProfile> profile_;
  mutable Mutex mutex_;
  PerOperation<OperationResults> operations_ ABSL_GUARDED_BY(mutex_);
  IntervalLog intervals_ ABSL_GUARDED_BY(mutex_);
  std::vector<Step> steps_ ABSL_GUARDED_BY(mutex_);
  std::map<std::pair<std::string, std::string>, LoadError> errors_ ABSL_GUARDED_BY(mutex_);
  Histogram refused_ ABSL_GUARDED_BY(mutex_), echo_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t resumed_ ABSL_GUARDED_BY(mutex_) = 0, lost_ ABSL_GUARDED_BY(mutex_) = 0;
  Glance glance_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::cli
