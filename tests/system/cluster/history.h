// History: what several clients did to the handle sets of one session and what they were told, and
// whether one order of these calls explains all of it (Herlihy and Wing call that linearizable).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace arap::cluster {

// A handle set as an answer tells it.
struct SetState {
  std::set<std::string> handles;
  std::uint64_t revision = 0;  // one more with every edit

  friend bool operator==(const SetState&, const SetState&) = default;
  friend auto operator<=>(const SetState&, const SetState&) = default;
};

enum class CallKind : std::uint8_t { kCompile, kEdit, kRead };

struct Call {
  using Time = std::chrono::steady_clock::time_point;

  CallKind kind = CallKind::kRead;
  std::string set;
  // Of a compilation all handles. An edit removes first; each handle is added once in the history
  // of a set.
  std::set<std::string> add, remove;
  Time begin;
  // When the answer came. Nothing: there was none, and it may have been done at any time after its
  // begin, or never.
  std::optional<Time> end;
  // Of an answered call: the set afterwards, nothing when there was no such set.
  std::optional<SetState> told;

  // "edit h +a7 -a3 [1.203 s, 1.207 s] → revision 4 of {…}", with times since `start`.
  std::string Describe(Time start) const;
};

enum class Verdict : std::uint8_t {
  kExplained,
  kWrong,      // no order of the calls gives these answers
  kUndecided,  // more orders than can be looked at
};

struct Judgement {
  Verdict verdict = Verdict::kExplained;
  std::size_t call = 0;  // the first, by end, whose answer nothing explains, or no more was tried
};

// Judges the calls of one session, in any order. A call takes effect at one moment between its
// begin and its end. Works through them in the order of time with all states that the sets may have
// then; what is not answered costs up to twice the states until somebody has seen it.
Judgement Judge(const std::vector<Call>& calls);

}  // namespace arap::cluster
