// What the transport takes by itself: messages of the sizes of updates and shapes, answered by
// EchoService without any work.
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>
#include <vector>

#include "arap/client/client.h"
#include "client/cli/load/load_session.h"
#include "client/cli/load/results.h"

namespace arap::cli {

struct EchoPlan {
  std::size_t streams = 1, window = 1;  // a closed loop, as that of the load
  std::size_t request_bytes = 0, answer_bytes = 0;
  double seconds = 1;  // that count, after a quarter as much that does not
};

// The sizes of an update of so many handles, and of the shape that answers it.
void MeasureMessages(std::size_t handles, std::size_t vertices, client::PositionEncoding encoding,
                     EchoPlan& plan);

// Stream i is on connection i modulo their count. Faults: kUnimplemented where the server serves no
// EchoService, and whatever else ends a stream.
Result<TransportResults> RunEchoes(const std::vector<std::unique_ptr<LoadConnection>>& connections,
                                   const EchoPlan& plan, const std::stop_token& stop);

}  // namespace arap::cli
