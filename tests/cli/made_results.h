// Runs of load as tests want them, without a server.
#pragma once

#include <cmath>
#include <cstdint>

#include "client/cli/load/interval_log.h"
#include "client/cli/load/results.h"

namespace arap::cli {

// `seconds` of drags and edits, 100 of each a second, with response times from `micros` to a fifth more
// that are the same in every second, but for `micros_of_second` when that is told: then every drag of
// second k takes micros_of_second(k).
template <class Micros>
LoadResults MadeResults(int seconds, Micros micros_of_second) {
  LoadResults results;
  results.how = "open loop, 200 messages a second, half of them edits";
  results.settings = {{"--rate", 200}, {"--mix", "drag=1,edit=1"}};
  results.sessions = 2;
  results.streams = 4;
  results.connections = 1;
  results.vertices = 2500;
  results.handles = 8;
  results.seconds = seconds;
  IntervalLog log;
  for (int second = 0; second < seconds; ++second) {
    for (int i = 0; i < 100; ++i) {
      for (const Operation operation : {Operation::kDrag, Operation::kEdit}) {
        OperationResults& done = results.operations[operation];
        const double at = second + i / 100.0;
        const double micros = micros_of_second(second) * (1 + i / 500.0);
        ++done.sent;
        ++done.answered;
        done.response.Record(micros);
        done.service.Record(micros);
        done.queue.Record(micros / 10);
        done.solve.Record(micros / 5);
        log.Offered(operation, at);
        log.Answered(operation, at, micros);
      }
    }
  }
  results.intervals = log.Intervals(seconds);
  return results;
}
inline LoadResults MadeResults(int seconds = 6, double micros = 1000) {
  return MadeResults(seconds, [micros](int /*second*/) { return micros; });
}

// With something of everything that a run can have.
inline LoadResults FullResults() {
  LoadResults results = MadeResults();
  results.warm_up_seconds = 2;
  OperationResults& drag = results.operations[Operation::kDrag];
  drag.sent += 12;
  drag.failed = 12;
  drag.late = 7;
  drag.unsent = 5;
  drag.replaced = 3;
  drag.verified = 60;
  drag.wrong = 1;
  results.intervals[2].operations[Operation::kDrag].failed = 12;
  results.steps = {{100, 100, 2, 900, 1200, true},
                   {400, 390.5, 2, 5000, 44'000, false},
                   {200, 200, 2, 1000, 1900, true}};
  results.rate_found = 200;
  results.errors = {{"RESOURCE_EXHAUSTED", "OVERLOADED", 11, "The queue is <full> & more."},
                    {"", "BAD_REPLY", 1, "not the answer to the update"}};
  results.refused.Record(1500, 3);
  results.resumptions = 2;
  results.frames_lost = 4;
  results.echo.Record(80, 100);
  results.transport.emplace().seconds = 2;
  results.transport->round_trip.Record(90, 4000);
  results.own_nanos_per_message = 2500;
  return results;
}

}  // namespace arap::cli
