// Recovery: what a store did about a database that it found damaged.
#pragma once

#include <cstddef>
#include <string>

namespace arap::store {

struct Recovery {
  std::string kept_as;    // where the damaged database lies now
  std::size_t saved = 0;  // records that were carried over
  // Records that could not be read. As far as their keys are known their sessions answer kDataLoss
  // until they expire or are removed.
  std::size_t lost = 0;
  bool complete = false;  // false: there may have been records that left no trace
};

}  // namespace arap::store
