// The load generator: what every stream does, and one such stream.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <latch>
#include <map>
#include <string>
#include <vector>

#include "arap/client/client.h"

namespace arap::cli {

// The same for every stream. The server factors the mesh once.
struct LoadPlan {
  PlanarMesh mesh;
  std::vector<Handle> handles;
  std::vector<Complex> rests;  // of the handles
  double reach = 0;            // how far a target strays from its rest position
  std::chrono::duration<double> length{0};
  client::Delivery delivery = client::Delivery::kEvery;
  DeformOptions deform;
  double fps = 0;  // updates a second; 0: as fast as they are answered
};

// A grid of about `vertices` vertices with `handles` handles spread over it.
LoadPlan MakeLoadPlan(std::size_t vertices, std::size_t handles,
                      std::chrono::duration<double> length);

struct LoadSamples {
  std::vector<double> round_trip_micros;
  std::vector<double> queue_micros;
  std::vector<double> solve_micros;
  std::vector<double> refused_micros;           // how long it took to be told that there is no room
  std::map<std::string, std::uint64_t> errors;  // by reason
  std::string first_error;                      // a sentence, or empty
};

// Opens a session, registers, compiles and opens a stream; then waits at `start` for the others;
// then sends updates for the planned time, each when the one before is answered. With a rate it
// begins as soon as it is open, as hands do, and times are counted from when an update should have
// been sent: one that is held up by the one before counts its waiting too. Checks every answer: the
// right sequence, the right length, all finite; BAD_REPLY otherwise. `index` shifts the motion.
LoadSamples RunLoadStream(const client::Client& client, const LoadPlan& plan, std::size_t index,
                          std::latch& start);

}  // namespace arap::cli
