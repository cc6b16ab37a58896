// How long a thread goes on before others that wait for the processor have their turn.
#pragma once

#include <chrono>

namespace arap::runtime {

// Asks the kernel for turns of about so long for the calling thread and for those that it starts
// from now on; 0: as long as the kernel likes. Short turns come sooner, long ones are interrupted
// less: nobody's part of the processor becomes larger or smaller, as it would with a priority.
// Linux does so from 6.12 on, and by default takes 3 ms or less; where it does not, nothing changes.
void SetTimeSlice(std::chrono::microseconds slice);

// Whoever answers somebody who waits: frames, and what is between them and the network. Shorter ones cost more switches
// than they save waiting: with 0.2 ms sixteen streams get a quarter fewer updates, and nobody's frame comes sooner.
inline constexpr std::chrono::microseconds kQuickTurns{1'000};
// Whoever computes for long.
inline constexpr std::chrono::microseconds kLongTurns{3'000};

}  // namespace arap::runtime
