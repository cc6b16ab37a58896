// Mix: what streams are busy with, and how much of it is what.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "arap/base/result.h"
#include "client/cli/load/results.h"

namespace arap::cli {

// Drags and edits are messages of the stream; baking, flattening and registering are calls of its
// session beside it.
class Mix {
 public:
  // Drags alone.
  Mix() { weights_[Operation::kDrag] = 1; }
  // "drag=90,edit=5,bake=2,flatten=2,register=1": weights, of which only the ratios count; what is not
  // named does not happen. kInvalidOption, with the field "mix", for anything else.
  static Result<Mix> Parse(std::string_view text);

  // What the `number`-th message of a stream is, by the seed alone.
  Operation At(std::uint64_t seed, std::size_t stream, std::uint64_t number) const;
  bool Has(Operation operation) const { return weights_[operation] > 0; }

 private:
  PerOperation<double> weights_;
};

}  // namespace arap::cli
