// What an attack did to others, and whether that is allowed.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace arap::attack {

// What a well-behaved client saw for a while. Times are milliseconds.
struct Seen {
  std::vector<double> frames;    // of a drag of 30 updates a second, each from sent to answered
  std::vector<double> compiles;  // of a compilation of a few milliseconds
  std::vector<double> flattens;  // of a small flattening with a kept surface
  // Calls that did not end well, by what they were and how they ended: "compile UNAVAILABLE".
  std::map<std::string, std::size_t> failures;
  std::size_t surfaces_lost = 0;  // flattenings whose kept surface was there no more
  // Looks at /readyz beside a new connection that asks for the server's information.
  std::size_t looks = 0;
  std::size_t lies = 0;  // /readyz said ready and nobody was served, or the other way round
};

struct Measured {
  std::string name;
  std::string spent;  // by the attacker, in its own words
  Seen before, during;
  // The 99th percentile of the drag while nobody attacks, of the whole run: a few seconds before one
  // attack hardly have a 99th percentile.
  double unloaded = 0;
  std::size_t budget_bytes = 0, peak_bytes = 0;
  // From SIGTERM to the end, seconds; nothing when it had to be killed.
  std::optional<double> stopping;
  double drain_seconds = 0;
  std::string ended;  // how the server ended before it was told to; empty when it did not
};

// The value that 99 of 100 do not exceed, and the greatest. Of nothing: 0.
double Percentile99(std::vector<double> values);
double Worst(const std::vector<double>& values);

// Every broken promise in a few words; empty when all are kept:
// - frames: p99 at most three times that without an attack (and of a millisecond);
// - compilations at most 200 ms, flattenings at most 300 ms, nothing refused, no kept surface lost;
// - memory at most the budget and a fifth of it;
// - /readyz tells the truth;
// - the server lives, and ends within --drain-seconds and 2 s.
std::vector<std::string> BrokenPromises(const Measured& measured);

// The rows of the table, as wide as their heading.
std::string Heading();
std::string Row(const Measured& measured);

}  // namespace arap::attack
