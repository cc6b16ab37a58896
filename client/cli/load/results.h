// What a run of `arapctl load` has found: everything that reports, thresholds and comparisons are made
// of. The engine fills it, and so does the file that --json wrote.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "arap/base/result.h"
#include "client/cli/load/histogram.h"

namespace arap::cli {

// What a session may be busy with; a mix has several of them.
enum class Operation : std::uint8_t { kDrag, kEdit, kBake, kFlatten, kRegister };
inline constexpr std::array<std::string_view, 5> kOperationNames{"drag", "edit", "bake", "flatten",
                                                                 "register"};
inline constexpr std::size_t kOperations = kOperationNames.size();
constexpr std::string_view NameOf(Operation operation) {
  return kOperationNames[static_cast<std::size_t>(operation)];
}

// A value for each operation.
template <class T>
class PerOperation {
 public:
  T& operator[](Operation operation) { return values_[static_cast<std::size_t>(operation)]; }
  const T& operator[](Operation operation) const {
    return values_[static_cast<std::size_t>(operation)];
  }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }

 private:
  std::array<T, kOperations> values_{};
};

struct OperationResults {
  Histogram response;  // from when it should have been sent to its answer
  Histogram service;   // from when it was sent to its answer
  Histogram queue;     // the server's own times, where an answer tells them
  Histogram solve;
  std::uint64_t sent = 0;
  std::uint64_t answered = 0;  // as it should be
  std::uint64_t failed = 0;  // answered by an error, badly, or not at all; LoadError has the kinds
  std::uint64_t late = 0;    // sent later than was intended
  std::uint64_t unsent = 0;  // due, but never sent
  std::uint64_t replaced = 0;  // by a newer update, before the server took it up
  std::uint64_t verified = 0;  // answers that were computed here too
  std::uint64_t wrong = 0;     // and were others

  bool Any() const { return sent + unsent > 0; }
  // Counts what `more` counts, too.
  void Add(const OperationResults& more);
};

// Of a stretch of time, of one operation. Times of answers count where the answer came.
struct IntervalOperation {
  std::uint64_t offered = 0;  // due to be sent
  std::uint64_t answered = 0;
  std::uint64_t failed = 0;
  double p50 = 0, p99 = 0, max = 0;  // of response, in microseconds; 0 without an answer
  std::uint64_t late = 0, unsent = 0, replaced = 0;  // of those that were due in it
};
struct Interval {
  double start = 0;    // seconds since the run began, warm-up left out
  double seconds = 0;  // how long it is
  PerOperation<IntervalOperation> operations;
};

// One rate of a ramp or of a search for the highest one.
struct LoadStep {
  double rate = 0;      // a second, offered
  double answered = 0;  // a second
  double seconds = 0;
  double p50 = 0, p99 = 0;  // of response, in microseconds
  bool met = false;         // what was asked of it, such as a p99 below a limit
};

// Messages of the same sizes that nothing was computed for (EchoService), before what counts.
struct TransportResults {
  double seconds = 0;
  Histogram round_trip;

  double PerSecond() const {
    return seconds > 0 ? static_cast<double>(round_trip.Count()) / seconds : 0;
  }
};

struct LoadError {
  std::string code;    // "RESOURCE_EXHAUSTED", or empty where there is none
  std::string reason;  // "OVERLOADED"; "BAD_REPLY" of answers that do not fit
  std::uint64_t count = 0;
  std::string first;  // the sentence of the first one, printable
};

struct LoadResults {
  std::string how;  // a line for people: "open loop, 1000 updates a second, Poisson"
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();  // by flag, as they were said
  std::size_t sessions = 0, streams = 0, connections = 0, vertices = 0, handles = 0;
  double seconds = 0;          // from the beginning to the last answer, warm-up left out
  double warm_up_seconds = 0;  // what came before that and is in no other number; 0: nothing
  PerOperation<OperationResults> operations;
  std::vector<Interval> intervals;   // by time; all but the last are equally long
  std::vector<LoadStep> steps;       // in the order in which they were tried
  std::optional<double> rate_found;  // the highest rate that a search found to be met, a second
  std::vector<LoadError> errors;     // by code and reason
  Histogram refused;                 // until a stream was told that there is no room
  std::uint64_t resumptions = 0;
  std::uint64_t frames_lost = 0;  // updates that a resumption left without an answer
  Histogram echo;                 // round trips of messages that compute nothing
  std::optional<TransportResults> transport;
  double own_nanos_per_message = 0;  // processor time of this program; 0: not measured

  // The operations that there were any of, in their order.
  std::vector<Operation> Done() const;
  // All operations together.
  OperationResults Total() const;
  // So many in all, a second.
  double PerSecond(std::uint64_t count) const;
};

// The document that --json writes (docs/arapctl.md).
nlohmann::ordered_json ToJson(const LoadResults& results);
// That document again, but for what ToJson rounds into percentiles. kInvalidOption, with the member that
// is wrong, for anything else.
Result<LoadResults> LoadResultsFromJson(const nlohmann::ordered_json& json);

}  // namespace arap::cli
