// Must: the value of a Result, for tests that cannot go on without it.
#pragma once

#include <cstdlib>
#include <utility>

#include <gtest/gtest.h>

#include "arap/base/result.h"

namespace arap::testing {

// Ends the program when there is a fault.
template <class T>
T Must(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << FaultName(result.error().kind) << ": " << result.error().message;
    std::abort();
  }
  return std::move(*result);
}

}  // namespace arap::testing
