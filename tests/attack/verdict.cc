#include "tests/attack/verdict.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace arap::attack {
namespace {

constexpr double kSlower = 3;           // times
constexpr double kLeastFrame = 1;       // ms: a quicker frame is as good as this
constexpr double kCompileMillis = 200;  // each
constexpr double kFlattenMillis = 300;  // each
constexpr double kMemory = 1.2;         // of the budget
constexpr double kEndSeconds = 2;       // beyond --drain-seconds

double AllowedFrame(const Measured& measured) {
  return kSlower * std::max(kLeastFrame, measured.unloaded);
}

std::size_t Failures(const Seen& seen) {
  std::size_t sum = 0;
  for (const auto& [what, count] : seen.failures) sum += count;
  return sum;
}

double OfBudget(const Measured& measured) {
  if (measured.budget_bytes == 0) return 0;
  return static_cast<double>(measured.peak_bytes) / static_cast<double>(measured.budget_bytes);
}

template <class... Values>
std::string Text(const char* format, Values... values) {
  std::array<char, 512> line{};
  std::snprintf(line.data(), line.size(), format, values...);  // NOLINT(*-vararg)
  return line.data();
}

}  // namespace

double Percentile99(std::vector<double> values) {
  if (values.empty()) return 0;
  const std::size_t rank = (99 * values.size() + 99) / 100 - 1;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank),
                   values.end());
  return values[rank];
}

double Worst(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

std::vector<std::string> BrokenPromises(const Measured& measured) {
  std::vector<std::string> broken;
  const Seen& during = measured.during;
  const auto check = [&](bool kept, const std::string& what) {
    if (!kept) broken.push_back(what);
  };
  check(measured.ended.empty(), "the server ended: " + measured.ended);
  check(!during.frames.empty() && !during.compiles.empty() && !during.flattens.empty(),
        "nothing was answered");
  const double frame = Percentile99(during.frames), allowed = AllowedFrame(measured);
  check(frame <= allowed, Text("frame %.0f ms, allowed %.0f", frame, allowed));
  const double compile = Worst(during.compiles), flatten = Worst(during.flattens);
  check(compile <= kCompileMillis, Text("compilation %.0f ms", compile));
  check(flatten <= kFlattenMillis, Text("flattening %.0f ms", flatten));
  for (const auto& [what, count] : during.failures) check(false, Text("%zu × ", count) + what);
  check(during.surfaces_lost == 0, Text("%zu kept surfaces lost", during.surfaces_lost));
  check(during.lies == 0, Text("/readyz wrong %zu of %zu times", during.lies, during.looks));
  check(OfBudget(measured) <= kMemory, Text("memory %.2f of the budget", OfBudget(measured)));
  if (!measured.ended.empty()) return broken;
  if (measured.stopping) {
    check(*measured.stopping <= measured.drain_seconds + kEndSeconds,
          Text("%.1f s to stop", *measured.stopping));
  } else {
    check(false, "does not stop");
  }
  return broken;
}

std::string Heading() {
  return Text("%-22s %15s %9s %9s %8s %6s %6s %6s  %s", "attack", "frame p99 ms", "compile",
              "flatten", "refused", "÷mem", "lies", "stop s", "spent; what broke");
}

std::string Row(const Measured& measured) {
  const Seen& during = measured.during;
  std::string row =
      Text("%-22s %6.1f →%7.1f %9.0f %9.0f %8zu %6.2f %6zu %6.1f  ", measured.name.c_str(),
           Percentile99(measured.before.frames), Percentile99(during.frames),
           Worst(during.compiles), Worst(during.flattens), Failures(during), OfBudget(measured),
           during.lies, measured.stopping.value_or(-1));
  row += measured.spent;
  const std::vector<std::string> broken = BrokenPromises(measured);
  row += broken.empty() ? "; HELD" : "; FELL:";
  for (std::size_t i = 0; i < broken.size(); ++i) row += (i > 0 ? ", " : " ") + broken[i];
  return row;
}

}  // namespace arap::attack
