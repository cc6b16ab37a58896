// What the commands say: faults and warnings on standard error, and what a set of times amounts to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "arap/base/result.h"
#include "arap/client/mesh.h"
#include "client/cli/exit_code.h"

namespace arap::cli {

// Foreign text, a server's say, as it may be printed: what steers a terminal, turns or hides writing,
// or is no UTF-8 is shown as an escape (\x1b, \u202e), and what goes on for too long is cut.
std::string Printable(std::string_view text);
// Reports as they are written: indented, and whatever is not ASCII as an escape.
std::string JsonText(const nlohmann::ordered_json& json);

// "REASON: message (elements 3 7; field mesh.triangles; limit = 5)", printable.
std::string Describe(const Fault& fault);
// "1 frame", "2 frames": words of which more take an s.
std::string Numbered(std::uint64_t count, std::string_view one);
// "DEGENERATE_TRIANGLE".
std::string ReasonOf(const Fault& fault);

// Exit codes without a fault; exit_code.h has all of them.
inline constexpr int kOk = static_cast<int>(Exit::kOk);
inline constexpr int kFailed = static_cast<int>(Exit::kFailed);
inline constexpr int kUsage = static_cast<int>(Exit::kUsage);

// Prints the fault on standard error. Answers its exit code.
int Complain(const Fault& fault);
// kOk, or Complain.
int ExitCode(const Status& done);
// Prints what the server repaired or ignored on standard error, not more than a screenful.
void PrintWarnings(const std::vector<Warning>& warnings);
// All that PrintWarnings was given since the program began.
const std::vector<Warning>& PrintedWarnings();

// Standard output is for the data that `flag` writes there ("--out"), and what is for people goes to
// standard error. False when it is another's already.
bool TakeStandardOutput(const std::string& flag);
// Prints a summary for people: on standard output, or on standard error when the other is taken.
void Say(std::string_view text);

struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0, max = 0;
};

// Exact: the smallest sample that so many percent do not exceed. Zeros without samples.
Percentiles PercentilesOf(std::vector<double> samples);
// {"p50": …, "p90": …, "p99": …, "max": …}.
nlohmann::ordered_json ToJson(const Percentiles& times);

}  // namespace arap::cli
