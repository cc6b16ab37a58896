// What tests do to a server under a running drag: it is killed, drained or frozen, and is there
// again.
#pragma once

#include <cstddef>
#include <functional>
#include <ostream>

#include "tests/system/fault/server_process.h"

namespace arap::fault {

enum class Harm { kKill, kDrain, kFreeze };

// "Kill".
const char* NameOf(Harm harm);
inline void PrintTo(Harm harm, std::ostream* out) { *out << NameOf(harm); }

// How often a stream is harmed: ARAP_RESUME_ROUNDS, 2 unless told; 20 are asked of a release.
std::size_t Rounds();

// Does it to a server that listens on "unix:{}/socket", and waits until it listens again. One that
// is frozen goes on when somebody has noticed, who then connects anew. `meanwhile` is called when
// the harm is done and before anything is waited for. False with a failure of the test.
bool Do(Harm harm, ServerProcess& server, const std::function<void()>& meanwhile = nullptr);

}  // namespace arap::fault
