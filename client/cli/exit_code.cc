#include "client/cli/exit_code.h"

#include <algorithm>
#include <iterator>

namespace arap::cli {
namespace {

constexpr ExitClass kClasses[] = {
    {Exit::kOk, "ok", "done"},
    {Exit::kFailed, "failed", "the work was done and found wanting: `load` saw errors"},
    {Exit::kUsage, "usage", "the command line, the environment or the config is wrong"},
    {Exit::kRefused, "refused", "a mesh, a track, an option or a name was refused"},
    {Exit::kNotFound, "not_found", "a file, a session or what is asked for in it is not there"},
    {Exit::kDenied, "denied", "no identity, or one that may not do this"},
    {Exit::kUnavailable, "unavailable", "no server, one that goes away, or no answer in time"},
    {Exit::kOverloaded, "overloaded", "a full queue, a quota or no memory: try again later"},
    {Exit::kInternal, "internal", "a bug, damaged data, or a file that could not be written"},
    {Exit::kMissed, "missed", "the work was done, and a --threshold of it was missed"},
    {Exit::kInterrupted, "interrupted", "Ctrl-C"},
};

}  // namespace

std::span<const ExitClass> ExitClasses() { return kClasses; }

const ExitClass& InfoOf(Exit exit) {
  return *std::find_if(std::begin(kClasses), std::end(kClasses),
                       [exit](const ExitClass& one) { return one.exit == exit; });
}

Exit ExitOf(FaultKind kind) {
  const FaultInfo& info = InfoOf(kind);
  switch (info.code) {
    case StatusCode::kOk:
      return Exit::kOk;
    case StatusCode::kInvalidArgument:
    case StatusCode::kAlreadyExists:
    case StatusCode::kFailedPrecondition:
    case StatusCode::kOutOfRange:
    case StatusCode::kUnimplemented:
      return Exit::kRefused;
    case StatusCode::kNotFound:
      return Exit::kNotFound;
    case StatusCode::kPermissionDenied:
    case StatusCode::kUnauthenticated:
      return Exit::kDenied;
    case StatusCode::kDeadlineExceeded:
    case StatusCode::kAborted:
    case StatusCode::kUnavailable:
      return Exit::kUnavailable;
    case StatusCode::kResourceExhausted:
      return info.retry == kLimitRetry ? Exit::kRefused : Exit::kOverloaded;
    case StatusCode::kCancelled:
      return Exit::kInterrupted;
    case StatusCode::kUnknown:
    case StatusCode::kInternal:
    case StatusCode::kDataLoss:
      break;
  }
  return Exit::kInternal;
}

}  // namespace arap::cli
