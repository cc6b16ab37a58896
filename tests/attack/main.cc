// Attacks a real arapd in every way that we know, one after the other, and prints a table.
//
// Usage: arap_attack [--list] [--server ARAPD] [NAME…]      (all unless told). See script/attack.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/runtime/time_slice.h"
#include "tests/attack/attacker.h"
#include "tests/attack/stage.h"
#include "tests/attack/verdict.h"

namespace arap::attack {
namespace {

const Attack* Find(const std::vector<Attack>& attacks, const std::string& name) {
  const auto found =
      std::ranges::find_if(attacks, [&](const Attack& attack) { return name == attack.name; });
  if (found != attacks.end()) return &*found;
  std::fprintf(stderr, "there is no attack '%s': see --list\n", name.c_str());
  return nullptr;
}

// Its own guards: a minute, and 6 GB of address space.
int BeAttacker(std::span<char* const> arguments) {
  if (arguments.size() != 4) return 2;
  runtime::SetTimeSlice(std::chrono::microseconds(0));
  alarm(60);
  const rlimit space{rlim_t{6} << 30u, rlim_t{6} << 30u};
  setrlimit(RLIMIT_AS, &space);
  const std::vector<Attack> attacks = AllAttacks();
  const Attack* const attack = Find(attacks, arguments[0]);
  if (attack == nullptr) return 2;
  Attacker attacker(arguments[1], arguments[2], arguments[3]);
  attack->run(attacker);
  attacker.Hold();
}

int List(const std::vector<Attack>& attacks) {
  for (const Attack& attack : attacks) std::printf("%-22s %s\n", attack.name, attack.what);
  return 0;
}

int RunAll(const StageOptions& options, const std::vector<Attack>& attacks,
           std::span<char* const> names) {
  std::vector<const Attack*> chosen;
  for (const char* name : names) {
    chosen.push_back(Find(attacks, name));
    if (chosen.back() == nullptr) return 2;
  }
  if (names.empty()) {
    for (const Attack& attack : attacks) chosen.push_back(&attack);
  }
  // The bystander stands for a client on a machine of its own, where nobody else takes its turn.
  runtime::SetTimeSlice(runtime::kQuickTurns);
  std::vector<Measured> all;
  std::vector<double> unloaded;
  for (const Attack* attack : chosen) {
    std::fprintf(stderr, "%zu of %zu: %s\n", all.size() + 1, chosen.size(), attack->name);
    all.push_back(RunAttack(*attack, options));
    const std::vector<double>& before = all.back().before.frames;
    unloaded.insert(unloaded.end(), before.begin(), before.end());
  }
  std::printf("%s\n", Heading().c_str());
  std::size_t fell = 0;
  for (Measured& measured : all) {
    measured.unloaded = Percentile99(unloaded);
    std::printf("%s\n", Row(measured).c_str());
    if (!BrokenPromises(measured).empty()) ++fell;
  }
  std::printf(
      "%zu attacks, %zu held, %zu fell; without an attack 99 of 100 of %zu frames took at most "
      "%.1f ms\n",
      all.size(), all.size() - fell, fell, unloaded.size(), Percentile99(unloaded));
  return fell == 0 ? 0 : 1;
}

}  // namespace
}  // namespace arap::attack

int main(int argc, char** argv) {
  const std::span<char*> arguments(argv, static_cast<std::size_t>(argc));
  ::testing::InitGoogleTest();
  const std::string first = argc > 1 ? arguments[1] : "";
  if (first == "--as-attacker") return arap::attack::BeAttacker(arguments.subspan(2));
  const std::vector<arap::attack::Attack> attacks = arap::attack::AllAttacks();
  if (first == "--list") return arap::attack::List(attacks);
  arap::attack::StageOptions options;
  options.self = std::filesystem::read_symlink("/proc/self/exe");
  const bool other = first == "--server" && argc > 2;
  if (other) options.server = arguments[2];
  return arap::attack::RunAll(options, attacks, arguments.subspan(other ? 3 : 1));
}
