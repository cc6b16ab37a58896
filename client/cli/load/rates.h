// The rates of a run: as a profile says them while it goes on, or one after the other to find the
// highest that a server meets.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "arap/base/result.h"

namespace arap::cli {

// Pieces one behind the other, on each of which the rate goes straight from one value to another.
// Immutable; copies are cheap.
class RateProfile {
 public:
  struct Piece {
    double seconds = 0;       // above 0
    double from = 0, to = 0;  // a second, not below 0
    bool counts = true;       // else it warms the next one up

    double mean() const { return (from + to) / 2; }
  };

  static RateProfile Constant(double rate, double seconds);
  // "step:100,200,400": these rates, each for the same part of `seconds`. "ramp:100,1000": from one to
  // the other, in ten pieces. kInvalidOption, with the field "profile", for anything else.
  static Result<RateProfile> Parse(std::string_view text, double seconds);

  // The same with so many seconds before each piece, at the rate with which it begins, that do not count.
  RateProfile WarmedUp(double seconds) const;

  double seconds() const { return seconds_; }
  // How many of the first `time` seconds count; what is behind the end does.
  double Counted(double time) const;
  const std::vector<Piece>& pieces() const { return pieces_; }
  // Which piece a time falls into; the last one from the end on. Two nanoseconds early are on time: times
  // come rounded to them.
  std::size_t PieceAt(double time) const;

  // How many messages are due in the first `time` seconds; a part of one counts as such.
  double Before(double time) const;
  // When so many are due; nothing when there are not so many.
  std::optional<double> When(double count) const;

 private:
  explicit RateProfile(std::vector<Piece> pieces);

  std::vector<Piece> pieces_;
  double seconds_ = 0;
};

// Doubles the rate from the first one until it is not met, or halves it until it is; then tries the
// geometric mean of the highest that was met and the lowest above it that was not, until they are
// within `resolution` of each other. A server that meets a rate is expected to meet all below it.
class RateSearch {
 public:
  static constexpr double kLowest = 0.1, kHighest = 1e6;  // a second

  // `resolution`: 0.05 finds the rate to 5 %.
  RateSearch(double first, double resolution) : resolution_(resolution), next_(first) {}

  // The rate to try; nothing when all is known.
  std::optional<double> next() const { return next_; }
  // That rate was tried.
  void Tried(bool met);

  // The highest rate that was met so far.
  std::optional<double> found() const { return met_; }

 private:
  double resolution_;
  std::optional<double> next_, met_, missed_;
};

}  // namespace arap::cli
