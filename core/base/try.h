// TRY: go on with the value of a Result, or return its fault.
//
//   TRY(auto mesh, ReadMesh(path));    // declares `mesh`; returns the fault when there is one
//   TRY(session_, Find(key));          // assigns
//   CHECK_OK(Validate(mesh));          // for a Status, or a Result whose value is not needed
//
// Not in the installed headers: macros have no namespace.
//
// OrOutOfMemory: a failed allocation inside a job becomes the job's fault.
#pragma once

#include <new>
#include <utility>

#include "arap/base/result.h"

#define ARAP_JOIN_AGAIN(a, b) a##b
#define ARAP_JOIN(a, b) ARAP_JOIN_AGAIN(a, b)
#define ARAP_TRY_AS(result, value, ...)                        \
  auto result = (__VA_ARGS__);                                 \
  if (!result) return ::arap::Fail(std::move(result).error()); \
  value = *std::move(result)

#define TRY(value, ...) ARAP_TRY_AS(ARAP_JOIN(try_result_, __LINE__), value, __VA_ARGS__)

#define CHECK_OK(...)                                     \
  do {                                                    \
    if (auto try_status = (__VA_ARGS__); !try_status)     \
      return ::arap::Fail(std::move(try_status).error()); \
  } while (false)

namespace arap {

// What `job` returns (a Result or a Status), or kOutOfMemory when an allocation in it failed. For
// the edge of a job: inside, memory is not looked after, and destructors give back what was taken.
template <class Job>
auto OrOutOfMemory(Job job) -> decltype(job()) {
  try {
    return job();
  } catch (const std::bad_alloc&) {
    return Fail(FaultKind::kOutOfMemory, "There is not enough memory for this.");
  }
}

}  // namespace arap
