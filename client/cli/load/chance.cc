#include "client/cli/load/chance.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <string>

#include <fmt/format.h>

namespace arap::cli {
namespace {

constexpr double kMostWeight = 1e9;

auto NoMix(std::string_view text, const std::string& why) {
  return Fail(
      Fault(FaultKind::kInvalidOption,
            fmt::format("{} is no mix: {}. It is drag=90,edit=5,bake=2,flatten=2,register=1, "
                        "or some of these.",
                        text, why))
          .Field("mix"));
}

}  // namespace

Result<Mix> Mix::Parse(std::string_view text) {
  Mix mix;
  mix.weights_[Operation::kDrag] = 0;
  PerOperation<bool> seen{};
  for (std::string_view rest = text;;) {
    const std::string_view item = rest.substr(0, rest.find(','));
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::string_view name = item.substr(0, equals);
    const auto* const found = std::find(kOperationNames.begin(), kOperationNames.end(), name);
    if (found == kOperationNames.end()) {
      return NoMix(text, fmt::format("there is no operation \"{}\"", name));
    }
    const auto operation = static_cast<Operation>(found - kOperationNames.begin());
    const std::string_view number = item.substr(std::min(equals + 1, item.size()));
    double weight = 0;
    const char* const end = number.data() + number.size();
    const auto [stop, error] = std::from_chars(number.data(), end, weight);
    if (error != std::errc() || stop != end || !(weight >= 0 && weight <= kMostWeight)) {
      return NoMix(text, fmt::format("\"{}\" is no weight from 0 to {:.0f}", number, kMostWeight));
    }
    if (std::exchange(seen[operation], true)) {
      return NoMix(text, fmt::format("{} is there twice", name));
    }
    mix.weights_[operation] = weight;
    if (item.size() == rest.size()) break;
    rest.remove_prefix(item.size() + 1);
  }
  if (std::accumulate(mix.weights_.begin(), mix.weights_.end(), 0.0) <= 0) {
    return NoMix(text, "all weights are 0");
  }
  return mix;
}

Operation Mix::At(std::uint64_t seed, std::size_t stream, std::uint64_t number) const {
  const double all = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  double drawn = all * DrawPart(seed, Draw::kOperation, stream, number);
  Operation last = Operation::kDrag;
  for (std::size_t i = 0; i < kOperations; ++i) {
    const auto operation = static_cast<Operation>(i);
    if (!Has(operation)) continue;
    last = operation;
    drawn -= weights_[operation];
    if (drawn < 0) break;
  }
  return last;
}

}  // namespace arap::cli
