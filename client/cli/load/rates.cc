#include "client/cli/load/rates.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace arap::cli {
namespace {

constexpr double kMostPerSecond = 1e7;
constexpr std::size_t kMostPieces = 1000;
constexpr std::size_t kRampPieces = 10;

auto NoProfile(std::string_view text, std::string_view why) {
  return Fail(Fault(FaultKind::kInvalidOption,
                    fmt::format("{} is no profile: {}. It is step:RATE,RATE,… or ramp:FROM,TO, in "
                                "messages a second.",
                                text, why))
                  .Field("profile"));
}

// Due after `time` seconds of the piece.
double DueIn(const RateProfile::Piece& piece, double time) {
  return time * (piece.from + (piece.to - piece.from) * time / (2 * piece.seconds));
}

// The other way round, for a count that the piece reaches.
double TimeIn(const RateProfile::Piece& piece, double count) {
  const double slope = (piece.to - piece.from) / piece.seconds;
  const double root = std::sqrt(std::max(piece.from * piece.from + 2 * count * slope, 0.0));
  return count == 0 ? 0 : 2 * count / (piece.from + root);
}

}  // namespace

RateProfile::RateProfile(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
  for (const Piece& piece : pieces_) seconds_ += piece.seconds;
}

RateProfile RateProfile::Constant(double rate, double seconds) {
  return RateProfile({{seconds, rate, rate}});
}

Result<RateProfile> RateProfile::Parse(std::string_view text, double seconds) {
  const std::string_view kind = text.substr(0, text.find(':'));
  if (kind.size() == text.size()) return NoProfile(text, "it has no colon");
  std::vector<double> rates;
  for (std::string_view rest = text.substr(kind.size() + 1);;) {
    const std::string_view word = rest.substr(0, rest.find(','));
    double rate = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), rate);
    const bool number = error == std::errc() && stop == word.data() + word.size();
    if (!number || !(rate >= 0 && rate <= kMostPerSecond)) {
      return NoProfile(text,
                       fmt::format("\"{}\" is not a rate from 0 to {:.0f}", word, kMostPerSecond));
    }
    rates.push_back(rate);
    if (rates.size() > kMostPieces) return NoProfile(text, "it has more than 1000 steps");
    if (word.size() == rest.size()) break;
    rest.remove_prefix(word.size() + 1);
  }
  std::vector<Piece> pieces;
  if (kind == "step") {
    const double each = seconds / static_cast<double>(rates.size());
    for (const double rate : rates) pieces.push_back({each, rate, rate});
  } else if (kind == "ramp") {
    if (rates.size() != 2) return NoProfile(text, "a ramp has two rates");
    const double part = 1.0 / kRampPieces;
    for (std::size_t i = 0; i < kRampPieces; ++i) {
      const auto at = [&](std::size_t k) {
        return rates[0] + (rates[1] - rates[0]) * part * static_cast<double>(k);
      };
      pieces.push_back({seconds * part, at(i), at(i + 1)});
    }
  } else {
    return NoProfile(text, fmt::format("\"{}\" is neither step nor ramp", kind));
  }
  RateProfile profile(std::move(pieces));
  if (profile.Before(seconds) <= 0) return NoProfile(text, "nothing is ever sent");
  return profile;
}

RateProfile RateProfile::WarmedUp(double seconds) const {
  if (seconds <= 0) return *this;
  std::vector<Piece> pieces;
  for (const Piece& piece : pieces_) {
    pieces.push_back({seconds, piece.from, piece.from, false});
    pieces.push_back(piece);
  }
  return RateProfile(std::move(pieces));
}

double RateProfile::Counted(double time) const {
  double counted = 0;
  for (const Piece& piece : pieces_) {
    if (time <= 0) return counted;
    if (piece.counts) counted += std::min(time, piece.seconds);
    time -= piece.seconds;
  }
  return counted + std::max(time, 0.0);
}

std::size_t RateProfile::PieceAt(double time) const {
  constexpr double kRounding = 2e-9;
  std::size_t i = 0;
  for (double end = pieces_[0].seconds; i + 1 < pieces_.size() && time + kRounding >= end;) {
    end += pieces_[++i].seconds;
  }
  return i;
}

double RateProfile::Before(double time) const {
  double count = 0;
  for (const Piece& piece : pieces_) {
    if (time <= 0) break;
    count += DueIn(piece, std::min(time, piece.seconds));
    time -= piece.seconds;
  }
  return count;
}

std::optional<double> RateProfile::When(double count) const {
  double start = 0;
  for (const Piece& piece : pieces_) {
    const double here = DueIn(piece, piece.seconds);
    if (count < here) return start + TimeIn(piece, count);
    count -= here;
    start += piece.seconds;
  }
  return std::nullopt;
}

void RateSearch::Tried(bool met) {
  if (!next_) return;
  (met ? met_ : missed_) = *next_;
  if (!missed_) {
    next_ = *met_ < kHighest ? std::optional(std::min(2 * *met_, kHighest)) : std::nullopt;
  } else if (!met_) {
    next_ = *missed_ > kLowest ? std::optional(std::max(*missed_ / 2, kLowest)) : std::nullopt;
  } else {
    const bool close = *missed_ <= *met_ * (1 + resolution_);
    next_ = close ? std::nullopt : std::optional(std::sqrt(*met_ * *missed_));
  }
}

}  // namespace arap::cli
