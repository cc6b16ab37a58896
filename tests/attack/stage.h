// One attack from beginning to end: a server under guard, a bystander, the attacker in a process of
// its own, and what came of it.
#pragma once

#include <chrono>
#include <string>

#include "tests/attack/attacker.h"
#include "tests/attack/verdict.h"

namespace arap::attack {

struct StageOptions {
  std::string self;    // this program, which runs attackers too
  std::string server;  // the arapd to attack; that of this build when it is empty
  std::chrono::milliseconds before{6'000}, during{10'000};
};

// Takes about 12 s and at most 30: the start, the quiet time, the attack, the stop. The
// server may have 8 GB of address space and 4,096 descriptors.
Measured RunAttack(const Attack& attack, const StageOptions& options);

}  // namespace arap::attack
