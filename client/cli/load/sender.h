// Sender: what one stream has to send next, and when. It knows neither the wire nor a clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "client/cli/load/arrivals.h"

namespace arap::cli {

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
