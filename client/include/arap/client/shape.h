// Deformed meshes: what to ask for and what comes back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arap/model/deform.h"

namespace arap::client {

using arap::DeformMode;
using arap::DeformOptions;
using arap::Pick;
using arap::ShapeQuality;

// How to deform, and how to answer.
struct ShapeOptions {
  DeformOptions deform = {};
  bool float64 = false;      // positions in double precision on the wire, else in single
  bool flipped_ids = false;  // also answer the ids of flipped triangles
};

// A deformed mesh and how good it is.
struct Shape {
  std::vector<Complex> positions;  // #V; float values unless float64 was asked
  // quality.worst_handle is 0: the server names the handle with the worst error, by its id.
  ShapeQuality quality;
  std::string worst_handle_id;             // empty without handles
  std::vector<std::uint32_t> flipped_ids;  // when asked
  std::vector<std::optional<Pick>> picks;  // one per picked point; empty where nothing lies
  std::uint64_t sequence = 0;              // of the update that it answers, or the frame's index
  std::uint64_t replaced = 0;              // updates that newer ones replaced since the last answer
  std::uint64_t handle_set_revision = 0;   // of the handle set that made this shape
  double queue_micros = 0;                 // time that the update waited for a worker
  double solve_micros = 0;                 // time that it took to compute
};

}  // namespace arap::client
