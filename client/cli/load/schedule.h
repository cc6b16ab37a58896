// When the messages of one stream are due, and when they are sent. It knows neither the wire nor a
// clock.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "client/cli/load/rates.h"

namespace arap::cli {

// Times of a run, since an origin that everything in the process shares.
using Moment = std::chrono::nanoseconds;
constexpr Moment FromSeconds(double seconds) {
  return std::chrono::duration_cast<Moment>(std::chrono::duration<double>(seconds));
}
constexpr double SecondsOf(Moment moment) { return std::chrono::duration<double>(moment).count(); }
constexpr double MicrosOf(Moment moment) {
  return std::chrono::duration<double, std::micro>(moment).count();
}

// Which part of the messages is a stream's.
struct ArrivalShare {
  std::size_t stream = 0, streams = 1;
  // The gaps between messages of a stream are drawn, as those of many independent people are: as
  // long as the mean on average, exponentially distributed. Else all messages of all streams are
  // equally far apart, and streams take turns.
  bool poisson = false;
  std::uint64_t seed = 0;
  // The first one is due at once: of streams that have their times to themselves.
  bool alone = false;
};

// For one thread. The same shares give the same times.
class Arrivals {
 public:
  Arrivals(std::shared_ptr<const RateProfile> profile, const ArrivalShare& share);

  // When the next one is due, since the beginning of the profile; nothing at its end.
  std::optional<Moment> next() const { return next_; }
  // It is the turn of the one after it.
  void Advance();

 private:
  void Find();

  std::shared_ptr<const RateProfile> profile_;
  ArrivalShare share_;
  std::uint64_t number_ = 0;
  double drawn_ = 0;  // of Poisson arrivals: where the next one is among the stream's own
  std::optional<Moment> next_;
};

// Never.
inline constexpr Moment kNever = Moment::max();
// What is due is never sent beyond so many without answer, so that memory is bounded; it waits, and
// its time counts from when it was due.
inline constexpr std::size_t kMostOnTheirWay = 4096;

// Between two moments a stream sends
//   closed loop: whenever fewer than `window` of its messages are without answer. A server that
//     stalls is sent nothing meanwhile, so its stall is one slow answer among many quick ones.
//   open loop: when its arrivals say so, whatever the server does. What is due and finds the window
//     full waits, and its time counts from when it was due: a stall is in the time of every message
//     that it has held up.
// For one thread; the time is told by who calls, and does not go back.
class Sender {
 public:
  struct Options {
    Moment begin{0}, end{0};
    std::size_t window = 1;                                          // 1 to kMostOnTheirWay
    std::uint64_t most = std::numeric_limits<std::uint64_t>::max();  // messages in all
  };
  struct Due {
    std::uint64_t number = 0;  // from 0
    Moment intended{0};
  };

  // Closed loop.
  explicit Sender(const Options& options) : options_(options) {}
  // Open loop; the profile of the arrivals begins with `options.begin`.
  Sender(const Options& options, Arrivals arrivals)
      : options_(options), arrivals_(std::move(arrivals)) {}

  // When the next one may be sent; kNever while the window is full, and at the end.
  Moment NextDue() const;
  // The next one, when it is due: it is on its way now. Of an open loop also after the end, while what
  // was due before is being sent.
  std::optional<Due> Take(Moment now);
  // One of those on their way has its answer, or will have none.
  void Answered() { --on_their_way_; }

  // Nothing is sent any more. `unsent` is told of each that was due by then and was not sent.
  void Close(Moment now, const std::function<void(const Due&)>& unsent);

  // Whether there is nothing to send any more and nothing on its way.
  bool is_done() const { return on_their_way_ == 0 && Intended() == kNever; }
  // How many were sent.
  std::uint64_t taken() const { return taken_; }
  Moment end() const { return options_.end; }
  std::size_t on_their_way() const { return on_their_way_; }

 private:
  // When the next one is due, if the window has room.
  Moment Intended() const;

  Options options_;
  std::optional<Arrivals> arrivals_;
  std::uint64_t taken_ = 0;
  std::size_t on_their_way_ = 0;
  bool closed_ = false;
};

}  // namespace arap::cli
