// How arapctl ends: one table of exit codes, and which of them a fault gets. The help, the man page and
// docs/arapctl.md tell the same table.
#pragma once

#include <span>
#include <string_view>

#include "arap/base/fault.h"

namespace arap::cli {

// The numbers are an interface: scripts go by them.
enum class Exit : int {
  kOk = 0,
  kFailed = 1,
  kUsage = 2,
  kRefused = 3,
  kNotFound = 4,
  kDenied = 5,
  kUnavailable = 6,
  kOverloaded = 7,
  kInternal = 8,
  kMissed = 9,
  kInterrupted = 130,  // 128 + SIGINT, as shells say it
};

struct ExitClass {
  Exit exit;
  std::string_view name;     // in the JSON of errors: "refused"
  std::string_view meaning;  // one line, for people
};

// All of them, in the order of their numbers.
std::span<const ExitClass> ExitClasses();
const ExitClass& InfoOf(Exit exit);

// That of a fault, by the status that the table of faults (arap/base/fault.h) gives its kind. What is
// beyond a limit that only an operator raises is refused; what is beyond a quota may be tried again.
Exit ExitOf(FaultKind kind);

}  // namespace arap::cli
